#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "retarget/pose.h"

namespace retarget {

/// A body scaled about the root: p' = s (p - p_root) + p_root'.
/// @param root, scaled_root  the root before and after scaling, metres.
[[nodiscard]] inline Eigen::Vector3d scaled_about_root(const Eigen::Vector3d& position,
                                                       double scale, const Eigen::Vector3d& root,
                                                       const Eigen::Vector3d& scaled_root) {
  return scale * (position - root) + scaled_root;
}

/// The axes of a target that follows a body: q' = q r. Inputs of any norm but zero.
[[nodiscard]] inline Eigen::Quaterniond offset_rotation(
    const Eigen::Quaterniond& world_from_bone, const Eigen::Quaterniond& bone_from_target) {
  return (world_from_bone.normalized() * bone_from_target).normalized();
}

/// The target of a scaled position: p'' = p' + q' o.
/// @param offset  in the target's frame, metres.
[[nodiscard]] inline Pose offset_target(const Eigen::Quaterniond& world_from_target,
                                        const Eigen::Vector3d& scaled,
                                        const Eigen::Vector3d& offset) {
  return {world_from_target, scaled + world_from_target * offset};
}

}  // namespace retarget
