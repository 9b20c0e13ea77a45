#pragma once

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Whether a joint lies on the way from another one up to the root; itself counts.
[[nodiscard]] bool is_above(const Skeleton& skeleton, int upper, int joint);

/// The end site of a joint that is farthest from it; zero: it has none.
[[nodiscard]] Eigen::Vector3d farthest_end(const Joint& joint);

/// The joint whose rotation turns a bone.
///
/// That is the bone's own joint, except on the way from the hips up to the file's root where the
/// root is not at the hips (a headset, for one): there the tree runs against the body, and the
/// joint that turns the part of the body between two joints is the one farther from the hips. And
/// where helpers stand in the joint's own place, without a length between: all that the bone
/// carries hangs from the last of them, which holds the turns of those before.
/// @return -1 for a bone without a joint.
[[nodiscard]] int rotation_joint(const BoneMap& map, const Skeleton& skeleton, Bone bone);

}  // namespace retarget
