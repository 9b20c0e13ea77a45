#pragma once

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Returns whether `upper` is `joint` or one of its ancestors.
[[nodiscard]] bool is_above(const Skeleton& skeleton, int upper, int joint);

/// Returns the end site that is farthest from its joint. Returns zero without end sites.
[[nodiscard]] Eigen::Vector3d farthest_end(const Joint& joint);

/// Returns the joint whose rotation turns a bone.
///
/// This is the bone's own joint, with two exceptions. If the file's root is not at the hips (a
/// headset, for example), the tree between root and hips runs against the body; the joint that
/// turns the segment between two such joints is the one farther from the hips. If helper joints
/// coincide with the bone's joint, everything that the bone carries is attached to the last of
/// them, which includes the rotations of the others.
/// @return -1 for a bone without a joint
[[nodiscard]] int rotation_joint(const BoneMap& map, const Skeleton& skeleton, Bone bone);

}  // namespace retarget
