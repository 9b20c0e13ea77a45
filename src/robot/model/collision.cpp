#include "robot/model/collision.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <utility>

#include "retarget/appearance.h"
#include "retarget/so3.h"

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

namespace {

// Returns true if contact between two bodies is not a self-collision.
bool is_exempt(const Robot& robot, int a, int b) {
  const mjModel& model = *robot.model();
  // MuJoCo treats rigidly connected bodies as one, identified by the first of them.
  const int rigid_a = model.body_weldid[a], rigid_b = model.body_weldid[b];
  const int parent_of_a = model.body_weldid[model.body_parentid[rigid_a]];
  const int parent_of_b = model.body_weldid[model.body_parentid[rigid_b]];
  if (rigid_a == rigid_b || parent_of_a == rigid_b || parent_of_b == rigid_a) return true;
  const auto& allowed = robot.profile().allowed_self_contact;
  return std::ranges::any_of(allowed, [a, b](const std::pair<int, int>& pair) {
    return pair == std::pair(a, b) || pair == std::pair(b, a);
  });
}

}  // namespace

CollisionModel::CollisionModel(const Robot& robot) : shapes_(robot.collision_shapes()) {
  for (const CollisionShape& shape : shapes_) in_body_.push_back(rounded(shape));
  const int count = static_cast<int>(shapes_.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (!is_exempt(robot, shapes_[a].body, shapes_[b].body)) pairs_.push_back({a, b});
    }
  }
}

void CollisionModel::place(std::span<const Pose> world_from_body,
                           std::span<RoundedShape> in_world) const {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    in_world[i] = placed(in_body_[i], world_from_body[shapes_[i].body]);
  }
}

void CollisionModel::near_pairs(std::span<const RoundedShape> placed, double margin,
                                std::vector<ShapePair>& near) const {
  near.clear();
  for (const ShapePair& pair : pairs_) {
    const RoundedShape& a = placed[pair.a];
    const RoundedShape& b = placed[pair.b];
    const double reach = a.bounding_radius + b.bounding_radius + margin;
    if (reach > 0.0 && (a.centre - b.centre).squaredNorm() < reach * reach) near.push_back(pair);
  }
}

}  // namespace retarget
