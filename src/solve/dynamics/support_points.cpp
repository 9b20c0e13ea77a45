#include "solve/dynamics/support_points.h"

#include <algorithm>
#include <numbers>

#include "base/math/trigonometry.h"
#include "robot/model/core_points.h"

namespace retarget {
using Eigen::Vector3d;

std::vector<SupportPoint> make_support_points(const Robot& robot) {
  const KinematicTree& tree = robot.tree();
  std::vector<SupportPoint> points;
  for (const Sole& sole : robot.profile().soles) {
    const KinematicTree::Attachment& at = tree.attachment(sole.body);
    if (at.link == KinematicTree::kWorld) continue;
    for (const Vector3d& point : sole.points) {
      points.push_back({at.link, at.link_from_body * point, 0.0, true});
    }
  }
  for (const CollisionShape& shape : robot.collision_shapes()) {
    const bool has_sole = std::ranges::any_of(
        robot.profile().soles, [&](const Sole& sole) { return sole.body == shape.body; });
    const KinematicTree::Attachment& at = tree.attachment(shape.body);
    if (has_sole || at.link == KinematicTree::kWorld) continue;
    for (const Vector3d& point : core_points(shape)) {
      points.push_back({at.link, at.link_from_body * point, shape.radius, false});
    }
  }
  return points;
}

Vector3d lowest_of(const SupportPoint& point, const TreeState& state) {
  return state.world_from_link[point.link] * point.in_link - point.radius * Vector3d::UnitZ();
}

void keep_outermost(std::span<const Vector3d> points, std::size_t most, std::vector<int>& chosen) {
  if (chosen.size() <= most) return;
  // Moves the selected points to the front. A point selected twice is kept once.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < most; ++i) {
    const portable::SineCosine way = portable::sin_cos(
        2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(most));
    const auto reach = [&](int index) {
      return way.cosine * points[index].x() + way.sine * points[index].y();
    };
    std::size_t farthest = 0;
    for (std::size_t k = 1; k < chosen.size(); ++k) {
      if (reach(chosen[k]) > reach(chosen[farthest])) farthest = k;
    }
    if (farthest >= kept) std::swap(chosen[kept++], chosen[farthest]);
  }
  chosen.resize(kept);
  std::ranges::sort(chosen);
}

}  // namespace retarget
