#pragma once

#include <Eigen/Core>
#include <span>

#include "retarget/kinematic_tree.h"

namespace retarget {

/// Moves a point along a sole towards the ankle until a force on it requires no ankle torque above
/// its limit. The ankle's joints are those of the foot's link and of its parent, if the two axes
/// are near each other.
/// @param torque_limits  limits by link of the tree, N m; infinity if unknown.
/// @param foot           link of the sole.
/// @param normal         normal of the sole, in the axes of the link, unit length.
/// @param force          contact force in the axes of the link, N; not zero.
/// @param point          point in the frame of the link, metres.
/// @return the moved point, in the frame of the link, metres.
[[nodiscard]] Eigen::Vector3d within_ankle_reach(const KinematicTree& tree,
                                                 std::span<const double> torque_limits, int foot,
                                                 const Eigen::Vector3d& normal,
                                                 const Eigen::Vector3d& force,
                                                 const Eigen::Vector3d& point);

}  // namespace retarget
