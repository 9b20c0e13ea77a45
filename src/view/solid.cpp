#include "view/solid.h"

#include <cmath>

namespace retarget {

SolidFigure robot_solids(const Robot& robot, const std::vector<CollisionShape>& shapes,
                         std::span<const double> qpos) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, qpos, world_from_body);
  SolidFigure figure;
  for (const CollisionShape& shape : shapes) {
    figure.push_back(
        {place(shape, world_from_body[static_cast<std::size_t>(shape.body)]), kRobotColour});
  }
  return figure;
}

SolidFigure human_solids(const HumanClip& human, int frame) {
  SolidFigure figure;
  for (const HumanLine& line : human_lines(human, frame)) {
    Solid solid;
    solid.colour = line.colour;
    solid.shape.centre = 0.5 * (line.from + line.to);
    solid.shape.radius = line.radius;
    solid.shape.half_axes[0] = 0.5 * (line.to - line.from);
    const double half_length = solid.shape.half_axes[0].norm();
    solid.shape.axis_count = half_length > 1e-6 ? 1 : 0;
    solid.shape.bounding_radius = half_length + line.radius;
    figure.push_back(solid);
  }
  return figure;
}

void shift(SolidFigure& figure, const Eigen::Vector3d& by) {
  for (Solid& solid : figure) solid.shape.centre += by;
}

Eigen::AlignedBox2d extent(const SolidFigure& figure, const Camera& camera) {
  Eigen::AlignedBox2d box;
  for (const auto& [shape, colour] : figure) {
    Eigen::Vector2d reach(shape.radius, shape.radius);
    for (int axis = 0; axis < shape.axis_count; ++axis) {
      reach += camera.project(shape.half_axes[static_cast<std::size_t>(axis)]).cwiseAbs();
    }
    const Eigen::Vector2d middle = camera.project(shape.centre);
    box.extend(Eigen::Vector2d(middle - reach));
    box.extend(Eigen::Vector2d(middle + reach));
  }
  return box;
}

}  // namespace retarget
