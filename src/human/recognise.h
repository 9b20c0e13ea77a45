#pragma once

#include <vector>

#include "human/bone_map.h"
#include "human/skeleton_profile.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

struct RecogniseOptions {
  /// Accept a body that lacks its arms or its legs, or one of them.
  bool partial = false;
};

/// Finds the human in a skeleton.
///
/// In this order, each answer being verified before it counts:
/// 1. the profile whose names and tree fit, if it is one alone;
/// 2. names with left and right in them, as far as the tree agrees;
/// 3. the shape of the tree alone: legs and arms are pairs of equal chains, left and right told
///    by where toes and knees point;
/// 4. if `partial`, what 1 and 2 found without arms or without legs.
///
/// Verified are: bones distinct and in line, left and right of equal lengths, thighs and shins in
/// proportion, head, torso, hips and feet one above the other, human proportions.
/// The tree is seen from the hips, wherever the file has its root; see rotation_joint.
///
/// @return kInput errors, without a file where only the skeleton is known: no human, limbs missing,
/// ambiguous names, sides that cannot be told.
[[nodiscard]] Result<BoneMap> recognise_skeleton(const Skeleton& skeleton,
                                                 const std::vector<SkeletonProfile>& profiles,
                                                 const RecogniseOptions& options = {});

/// The same with the poses of a motion, which say more than the zero pose (of some skeletons, such
/// as LAFAN1's, the latter is no pose of a human at all).
[[nodiscard]] Result<BoneMap> recognise_skeleton(const Clip& clip,
                                                 const std::vector<SkeletonProfile>& profiles,
                                                 const RecogniseOptions& options = {});

}  // namespace retarget
