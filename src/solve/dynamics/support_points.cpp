#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "base/math/convex_hull.h"
#include "base/math/segment.h"
#include "retarget/kinematic_tree.h"
#include "retarget/shape_distance.h"
#include "retarget/trigonometry.h"
#include "solve/dynamics/support_points.h"

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

void keep_outermost(std::span<const Vector3d> points, std::size_t most, std::vector<int>& chosen,
                    const Vector3d& forward) {
  if (chosen.size() <= most) return;
  // Moves the selected points to the front. A point selected twice is kept once.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < most; ++i) {
    const portable::SineCosine way = portable::sin_cos(
        2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(most));
    const double x = way.cosine * forward.x() - way.sine * forward.y();
    const double y = way.cosine * forward.y() + way.sine * forward.x();
    const auto reach = [&](int index) { return x * points[index].x() + y * points[index].y(); };
    std::size_t farthest = 0;
    for (std::size_t k = 1; k < chosen.size(); ++k) {
      if (reach(chosen[k]) > reach(chosen[farthest])) farthest = k;
    }
    if (farthest >= kept) std::swap(chosen[kept++], chosen[farthest]);
  }
  chosen.resize(kept);
  std::ranges::sort(chosen);
}

double margin_in_hull(const Eigen::Vector2d& point, std::vector<Eigen::Vector2d>& points) {
  // Non-finite values have no order and cannot be sorted.
  std::erase_if(points, [](const Eigen::Vector2d& each) { return !each.allFinite(); });
  reduce_to_hull(points);
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = points.size() > 2;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& from = points[i];
    const Eigen::Vector2d& to = points[(i + 1) % points.size()];
    nearest = std::min(nearest, (nearest_on_segment(point, from, to) - point).norm());
    inside = inside && cross_2d(to - from, point - from) >= 0.0;
  }
  return inside ? nearest : -nearest;
}

namespace {

constexpr double kLegOfG1 = 0.632;  // Metres.

// Joints from the base to a link.
std::vector<int> joints_to(const KinematicTree& tree, int link) {
  std::vector<int> joints;
  for (; link > 0; link = tree.links()[static_cast<std::size_t>(link)].parent) {
    joints.insert(joints.begin(), tree.links()[static_cast<std::size_t>(link)].joint);
  }
  return joints;
}

// Leg length (hip to knee to ankle), metres; 0 if the joints do not form a leg. The shank is the
// last long segment between consecutive joints, and the knee is the joint at its upper end.
double leg_length(const TreeState& state, const std::vector<int>& joints) {
  constexpr double kLong = 0.6;  // Share of the longest segment.
  const auto way = [&](std::size_t i) {
    return (state.anchor(joints[i + 1]) - state.anchor(joints[i])).norm();
  };
  double longest = 0.0;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) longest = std::max(longest, way(i));
  std::size_t knee = 0;
  for (std::size_t i = 1; i + 1 < joints.size(); ++i) {
    if (way(i) >= kLong * longest) knee = i;
  }
  if (knee == 0) return 0.0;
  const std::span all(joints);
  const Eigen::Vector3d hip = common_point(state, all.first(knee));
  const Eigen::Vector3d ankle = common_point(state, all.subspan(knee + 1));
  const Eigen::Vector3d& middle = state.anchor(joints[knee]);
  return (middle - hip).norm() + (ankle - middle).norm();
}

}  // namespace

double body_size(const Robot& robot) {
  const KinematicTree& tree = robot.tree();
  const TreeState state(tree, robot.zero_configuration());
  double longest = 0.0;
  for (const Sole& sole : robot.profile().soles) {
    const int link = tree.attachment(sole.body).link;
    longest = std::max(longest, leg_length(state, joints_to(tree, link)));
  }
  return longest > 0.0 ? std::round(100.0 * longest / kLegOfG1) / 100.0 : 1.0;
}

}  // namespace retarget
