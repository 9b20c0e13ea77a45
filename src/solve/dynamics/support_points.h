#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"

namespace retarget {

/// A point of a robot that may touch the floor: a point of a sole, or of another collision shape.
struct SupportPoint {
  int link = 0;  ///< Link of Robot::tree().
  Eigen::Vector3d in_link = Eigen::Vector3d::Zero();
  double radius = 0.0;  ///< Distance of the surface below the point, metres.
  bool of_sole = false;
};

/// A position at which a surface may push a robot, and the direction of the push without friction.
struct ContactPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< World axes, unit length.
};

/// The points of the soles, followed by the ends of capsules, spheres and the corners of boxes of
/// all bodies without a sole.
[[nodiscard]] std::vector<SupportPoint> make_support_points(const Robot& robot);

/// The lowest point of its surface, world, metres.
[[nodiscard]] Eigen::Vector3d lowest_of(const SupportPoint& point, const TreeState& state);

/// Reduces a selection to at most `most` points: the outermost ones in equally spaced horizontal
/// directions. The others lie approximately between them.
/// @param chosen  indices into `points`; receives the remaining ones in ascending order.
void keep_outermost(std::span<const Eigen::Vector3d> points, std::size_t most,
                    std::vector<int>& chosen);

/// Signed distance of a point inside the convex hull of some points to the hull's edge, metres;
/// negative outside. For one or two points, which enclose nothing, minus the distance to them.
/// @param points  at least one; modified.
[[nodiscard]] double margin_in_hull(const Eigen::Vector2d& point,
                                    std::vector<Eigen::Vector2d>& points);

/// Size of a robot: its leg length (hip to knee to ankle) relative to a G1's. Rounded to a
/// hundredth, so that the last digits of a model have no influence. Derived from the joints that
/// carry its soles; 1 if it has none.
[[nodiscard]] double body_size(const Robot& robot);

}  // namespace retarget
