#pragma once

#include <Eigen/Core>
#include <span>

#include "retarget/kinematic_tree.h"

namespace retarget {

/// Moves a point along a sole, towards the ankle, until a force on it needs no more torque than the
/// joints of the ankle have: those of the foot's link and of its parent, if their anchors are near
/// each other. The line of the force passes an axis at the distance torque / force.
/// @param torque_limits  by link of the tree, N m; infinity if unknown.
/// @param foot    link of the sole.
/// @param normal  of the sole, in the axes of the link.
/// @param force   in the axes of the link, N; not zero.
/// @param point   in the frame of the link, metres.
[[nodiscard]] Eigen::Vector3d within_ankle_reach(const KinematicTree& tree,
                                                 std::span<const double> torque_limits, int foot,
                                                 const Eigen::Vector3d& normal,
                                                 const Eigen::Vector3d& force,
                                                 const Eigen::Vector3d& point);

}  // namespace retarget
