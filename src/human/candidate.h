#pragma once

#include <optional>
#include <string>
#include <vector>

#include "human/body_poses.h"
#include "human/bone_map.h"
#include "human/joint_names.h"
#include "human/skeleton_profile.h"
#include "human/skeleton_tree.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// All that the ways of recognising look at.
struct BodySource {
  const Skeleton& skeleton;
  SkeletonTree tree;
  std::vector<JointName> names;  ///< Of all joints, normalised together.
  BodyPoses poses;

  /// `"name"` of a joint, for messages.
  [[nodiscard]] std::string quoted_name(int joint) const {
    return "\"" + skeleton.joint(joint).name + "\"";
  }
  [[nodiscard]] std::vector<std::string> quoted_names(const std::vector<int>& joints) const {
    std::vector<std::string> quoted;
    quoted.reserve(joints.size());
    for (const int joint : joints) quoted.push_back(quoted_name(joint));
    return quoted;
  }
  /// Length of the way along the tree from one joint to another.
  [[nodiscard]] double path_length(int a, int b) const {
    const std::vector<int> path = tree.path(a, b);
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      length += poses.lengths[tree.parent(path[i]) == path[i + 1] ? path[i] : path[i + 1]];
    }
    return length;
  }
};

/// A map that is still to be verified, nothing, or the error that joints of equal merit are. Here and
/// below errors name no file.
using Candidate = Result<std::optional<BoneMap>>;

/// The map of the one profile that fits well enough to be believed; of several that map alike, the one
/// with most in common. Nothing if none fits, or if those that fit best disagree.
///
/// How well it fits (0.9 is enough) is the Jaccard index of the names that lie in the body (mapped
/// joints and those between them) times the share of mapped bones that hang from the bone they should
/// hang from. Where none fits so, unknown joints that share a place with the one above or below them
/// do not count. Required names, marks, parents and directions must hold or the profile does not fit
/// at all.
[[nodiscard]] std::optional<BoneMap> recognise_by_profile(
    const BodySource& source, const std::vector<SkeletonProfile>& profiles);

/// Finds bones by words in the joint names, as far as the tree agrees.
///
/// Each limb is found whole: of all ways to choose its joints so that they lie in line, the one
/// whose names fit best, so that `LeftLeg` is the thigh above `LeftShin` and the shin below
/// `LeftUpLeg`. Limbs that are not found stay unmapped. Two ways of equal merit that do not lie in
/// line are an error naming the joints; of joints in line the one nearer the body counts.
[[nodiscard]] Candidate recognise_by_names(const BodySource& source);

/// Finds the body by the shape of the tree alone, whatever the joints are called.
///
/// Two joints are sought that each carry a pair of equal chains, the hips and the torso; the pairs
/// are legs and arms. What hangs on one side only (props, weapons) is in no pair. Which pair is
/// which is told by the head beside the arms, proportions and fingers; left from right by
/// left_is_left. Two answers of equal merit, or sides that the poses do not tell, are errors.
[[nodiscard]] Candidate recognise_by_shape(const BodySource& source);

/// Completes a map whose limbs, and head where there is one, are set: Hips where the legs meet,
/// Spine2 where the arms meet, Spine and Spine1 between them, Neck before the head. Bones that are
/// set already stay, except Hips.
void complete_trunk(const BodySource& source, BoneMap& map);

/// Notes for people: bones that the source lacks, spine joints that are folded into others.
void add_trunk_notes(const BodySource& source, BoneMap& map);

/// What speaks against a body being a human's.
struct HumanDoubts {
  std::vector<std::string> signs;  ///< Such as `the legs are shorter than the trunk`.
  bool proven = false;             ///< Enough signs that it is none.
};

/// Signs are a trunk longer than the legs, arms as long as the legs, names of animals' parts, and
/// in a motion a trunk that lies across the legs most of the time. Only with the last one count
/// narrow shoulders, a zero pose on four legs, feet as long as segments of legs, and single chains
/// that hang from both head and hips. Three prove it, and two of a body that is never seen to stand
/// or lie stretched, the first two of these four left out. People who crawl have one sign, or two
/// of poses.
[[nodiscard]] HumanDoubts doubt_human(const BodySource& source, const BoneMap& map);

/// What verification says of a map.
struct Verdict {
  std::vector<std::string> faults;  ///< Why the map cannot be right; empty: it may.
  std::vector<std::string> doubts;  ///< What is odd, for people.
  double confidence = 1.0;          ///< Factor for the map's confidence.
};

/// Holds a map against the tree, the lengths and the poses: bones distinct and in line, left and
/// right of equal lengths, thigh and shin in proportion, head over torso over hips over feet.
/// Bones that are missing are not judged.
[[nodiscard]] Verdict verify_bone_map(const BodySource& source, const BoneMap& map);

/// Limbs that a map lacks or has in part: `left arm`, `legs` and so on, also `hips` and `torso`;
/// empty: whole. Clavicles, hands, toes, neck and head are no limbs.
[[nodiscard]] std::vector<std::string> missing_parts(const BoneMap& map);

}  // namespace retarget
