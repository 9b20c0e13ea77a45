#pragma once

#include <vector>

#include "human/skeleton/skeleton_profile.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

struct RecogniseOptions {
  /// Accept a body that lacks one or both arms or legs.
  bool partial = false;
};

/// Finds the human in a skeleton.
///
/// Methods in order; each answer must pass verification:
/// 1. the only profile whose names and tree fit;
/// 2. names with left and right in them, where the tree agrees;
/// 3. the shape of the tree alone: legs and arms are pairs of equal chains, and the directions of
/// toes and knees distinguish left from right;
/// 4. with `partial`, the answers of 1 and 2 without arms or legs.
///
/// Verification checks that bones are distinct and in line, that left and right have equal lengths,
/// that thighs and shins are in proportion, that head, torso, hips and feet are above one another,
/// and that proportions are human. The tree is viewed from the hips, regardless of the file's root;
/// see rotation_joint.
///
/// @return kInput errors, without a file if only the skeleton is known: no human, missing limbs,
///   ambiguous names, undecidable sides.
[[nodiscard]] Result<BoneMap> recognise_skeleton(const Skeleton& skeleton,
                                                 const std::vector<SkeletonProfile>& profiles,
                                                 const RecogniseOptions& options = {});

/// Does the same with the poses of a motion, which are better evidence than the zero pose. The zero
/// pose of some skeletons, such as LAFAN1's, is not a human pose.
[[nodiscard]] Result<BoneMap> recognise_skeleton(const Clip& clip,
                                                 const std::vector<SkeletonProfile>& profiles,
                                                 const RecogniseOptions& options = {});

}  // namespace retarget
