#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"

namespace retarget {

/// A point of a robot that may touch the floor: a point of a sole or of another collision shape.
struct SupportPoint {
  int link = 0;                                       ///< Link of Robot::tree().
  Eigen::Vector3d in_link = Eigen::Vector3d::Zero();  ///< Position in the link frame, metres.
  double radius = 0.0;   ///< Radius of the sphere around the point, metres; 0 for points of soles.
  bool of_sole = false;  ///< Whether the point belongs to a sole.
};

/// Position and surface normal of a contact.
struct ContactPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< Towards the robot; world, unit length.
};

/// The points of all soles, then those of the collision shapes of bodies without a sole: ends of
/// capsules, centres of spheres, corners of boxes.
[[nodiscard]] std::vector<SupportPoint> make_support_points(const Robot& robot);

/// The lowest point of the sphere around a support point, world, metres.
[[nodiscard]] Eigen::Vector3d lowest_of(const SupportPoint& point, const TreeState& state);

/// Reduces a selection to at most `most` points: the outermost points in `most` equally spaced
/// horizontal directions. The other points lie approximately inside their convex hull.
/// @param points  world, metres.
/// @param chosen  indices into `points`; reduced, in ascending order.
/// @param forward  first of the directions: horizontal, unit length.
void keep_outermost(std::span<const Eigen::Vector3d> points, std::size_t most,
                    std::vector<int>& chosen,
                    const Eigen::Vector3d& forward = Eigen::Vector3d::UnitX());

/// Distance of a point from the edge of the convex hull of `points`, metres; positive inside,
/// negative outside. One or two points have no inside.
/// @param points  at least one; modified.
[[nodiscard]] double margin_in_hull(const Eigen::Vector2d& point,
                                    std::vector<Eigen::Vector2d>& points);

/// Size of a robot: ratio of its leg length (hip to knee to ankle) to a G1's. Rounded to a
/// hundredth, so that the last digits of a model have no effect. Measured along the joints from the
/// base to a sole; 1 if the robot has no soles.
[[nodiscard]] double body_size(const Robot& robot);

}  // namespace retarget
