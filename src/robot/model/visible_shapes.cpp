#include "robot/model/visible_shapes.h"

#include "base/math/so3.h"

namespace retarget {

std::vector<CollisionShape> visible_shapes(const Robot& robot) {
  constexpr double kLineRadius = 0.02;  // Metres.
  std::vector<CollisionShape> shapes = robot.collision_shapes();
  if (!shapes.empty()) return shapes;
  CollisionShape root;
  root.body = robot.root_body();
  root.radius = 2.0 * kLineRadius;
  shapes.push_back(root);
  for (const RobotBody& body : robot.bodies()) {
    const Eigen::Vector3d& far_end = body.parent_from_body.translation;
    if (body.parent <= 0 || far_end.norm() < 1e-6) continue;
    CollisionShape line;
    line.type = CollisionShape::Type::kCapsule;
    line.body = body.parent;
    line.body_from_shape = {rotation_between(Eigen::Vector3d::UnitZ(), far_end), 0.5 * far_end};
    line.radius = kLineRadius;
    line.half_length = 0.5 * far_end.norm();
    shapes.push_back(line);
  }
  return shapes;
}

}  // namespace retarget
