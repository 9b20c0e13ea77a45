#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"

namespace retarget {

/// Returns the model's contact primitives of the robot. Cylinders become capsules.
[[nodiscard]] std::vector<CollisionShape> contact_shapes(const Robot& robot);

/// A ball of a foot's contact shapes: an end of a capsule, a corner of a box (radius 0).
struct FootBall {
  Eigen::Vector3d centre;
  double radius = 0.0;
};

/// Returns the balls of a foot and the bodies fixed to it, in the foot's frame.
[[nodiscard]] std::vector<FootBall> foot_balls(const std::vector<CollisionShape>& shapes,
                                               const TreeState& posed, int foot);

/// Layer within which points touch a level floor, as a fraction of the leg's length.
inline constexpr double kSoleLayer = 0.01;
/// Length of a sole at least, likewise. A shorter foot touches the floor in a point or a line.
inline constexpr double kLeastSole = 0.05;

/// Returns how far a foot is turned from a level pose. A foot that touches a level floor with an
/// area is level. Otherwise its largest flat side that faces down, within 45 degrees, is its
/// underside; without one the foot counts as level.
/// @param balls  balls in any frame.
/// @param axes  unit vectors forward, up and right, as columns, in the same frame.
/// @param leg_length  metres.
/// @return rotation in the frame of the balls that turns the up axis to the underside's normal.
[[nodiscard]] Eigen::Quaterniond foot_tilt(std::vector<FootBall> balls, const Eigen::Matrix3d& axes,
                                           double leg_length);

}  // namespace retarget
