#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "retarget/pose.h"

namespace retarget {

/// Scales a position about the root: p' = s (p - p_root) + p_root'.
/// @param root, scaled_root  the root before and after scaling, metres.
[[nodiscard]] inline Eigen::Vector3d scaled_about_root(const Eigen::Vector3d& position,
                                                       double scale, const Eigen::Vector3d& root,
                                                       const Eigen::Vector3d& scaled_root) {
  return scale * (position - root) + scaled_root;
}

/// Target rotation q' = q r. The inputs need not be normalised, but must be non-zero.
[[nodiscard]] inline Eigen::Quaterniond offset_rotation(
    const Eigen::Quaterniond& world_from_bone, const Eigen::Quaterniond& bone_from_target) {
  return (world_from_bone.normalized() * bone_from_target).normalized();
}

/// Target pose with position offset: p'' = p' + q' o.
/// @param offset  in the target's frame, metres.
[[nodiscard]] inline Pose offset_target(const Eigen::Quaterniond& world_from_target,
                                        const Eigen::Vector3d& scaled,
                                        const Eigen::Vector3d& offset) {
  return {world_from_target, scaled + world_from_target * offset};
}

}  // namespace retarget
