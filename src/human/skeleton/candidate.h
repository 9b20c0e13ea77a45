#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "human/skeleton/joint_names.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/skeleton_profile.h"
#include "human/skeleton/skeleton_tree.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Input of all recognition methods.
struct BodySource {
  const Skeleton& skeleton;
  SkeletonTree tree;
  std::vector<JointName> names;  ///< All joints, normalised together.
  BodyPoses poses;

  /// Returns a joint's name in double quotes, for messages.
  [[nodiscard]] std::string quoted_name(int joint) const {
    return "\"" + skeleton.joint(joint).name + "\"";
  }
  [[nodiscard]] std::vector<std::string> quoted_names(const std::vector<int>& joints) const {
    std::vector<std::string> quoted;
    quoted.reserve(joints.size());
    for (const int joint : joints) quoted.push_back(quoted_name(joint));
    return quoted;
  }
  /// Returns the path length between two joints along the tree.
  [[nodiscard]] double path_length(int a, int b) const {
    const std::vector<int> path = tree.path(a, b);
    double length = 0.0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      length += poses.lengths[tree.parent(path[i]) == path[i + 1] ? path[i] : path[i + 1]];
    }
    return length;
  }
};

/// The bones of a limb from the trunk outwards, and whether a human must have them.
struct LimbRow {
  LimbBone bone;
  bool required;
};
using LimbRows = std::array<LimbRow, 4>;
inline constexpr LimbRows kLegRows = {{{LimbBone::kUpLeg, true},
                                       {LimbBone::kLeg, true},
                                       {LimbBone::kFoot, true},
                                       {LimbBone::kToe, false}}};
inline constexpr LimbRows kArmRows = {{{LimbBone::kShoulder, false},
                                       {LimbBone::kArm, true},
                                       {LimbBone::kForeArm, true},
                                       {LimbBone::kHand, false}}};

/// A map that still needs verification, nothing, or an error when candidate joints tie. Errors here
/// and below name no file.
using Candidate = Result<std::optional<BoneMap>>;

/// Returns the map of the only profile that fits well enough; of several profiles with equal maps,
/// the one with the most names in common. Returns nothing if no profile fits or the best ones
/// disagree.
///
/// The fit (at least 0.9) is the Jaccard index of the names inside the body (mapped joints and
/// those between them) times the share of mapped bones with the expected parent bone. If no profile
/// fits, a second pass ignores unknown joints that coincide with the joint above or below them. A
/// profile whose required names, marks, parents or directions do not hold is rejected.
[[nodiscard]] std::optional<BoneMap> recognise_by_profile(
    const BodySource& source, const std::vector<SkeletonProfile>& profiles);

/// Finds bones by words in the joint names, where the tree agrees.
///
/// Each limb is found as a whole: of all choices of joints in line, the one whose names fit best.
/// So `LeftLeg` is the thigh above `LeftShin` and the shin below `LeftUpLeg`. Limbs that are not
/// found stay unmapped. Two equally good choices that are not in line are an error that names the
/// joints; of joints in line the one nearer the body wins.
[[nodiscard]] Candidate recognise_by_names(const BodySource& source);

/// Finds the body by the shape of the tree alone, regardless of joint names.
///
/// The method looks for two joints that each carry a pair of equal chains, the hips and the torso;
/// the pairs are legs and arms. One-sided parts (props, weapons) are in no pair. The head near the
/// arms, proportions and fingers distinguish arms from legs; left_is_left distinguishes left from
/// right. Two equally good answers, or poses that do not reveal the sides, are errors.
[[nodiscard]] Candidate recognise_by_shape(const BodySource& source);

/// Completes a map whose limbs (and head, if any) are set: Hips where the legs meet, Spine2 where
/// the arms meet, Spine and Spine1 between them, Neck before the head. Keeps bones that are already
/// set, except Hips.
void complete_trunk(const BodySource& source, BoneMap& map);

/// Adds human-readable notes: bones that the source lacks, spine joints that are merged.
void add_trunk_notes(const BodySource& source, BoneMap& map);

/// Evidence that a body is not human.
struct HumanDoubts {
  std::vector<std::string> signs;  ///< Such as `the legs are shorter than the trunk`.
  bool proven = false;             ///< True: there are enough signs to conclude that it is not
                                   ///< human.
};

/// Collects signs that a body is not human. Basic signs: a trunk longer than the legs, arms as long
/// as the legs, names of animal parts, and a trunk that lies across the legs during most of the
/// motion. The last sign enables four more: narrow shoulders, a zero pose on four legs, feet as
/// long as leg segments, and single chains that hang from both head and hips. Three signs are
/// proof. For a body that never stands or lies stretched, two are, not counting narrow shoulders
/// and the zero pose. People who crawl have one sign, or two from poses.
[[nodiscard]] HumanDoubts doubt_human(const BodySource& source, const BoneMap& map);

/// Result of verifying a map.
struct Verdict {
  std::vector<std::string> faults;  ///< Reasons why the map must be wrong; empty: it may be right.
  std::vector<std::string> doubts;  ///< Human-readable oddities.
  double confidence = 1.0;          ///< Factor on the map's confidence.
};

/// Checks a map against the tree, the lengths and the poses: bones are distinct and in line, left
/// and right have equal lengths, thigh and shin are in proportion, head, torso, hips and feet are
/// in this order from top to bottom. Missing bones are not checked.
[[nodiscard]] Verdict verify_bone_map(const BodySource& source, const BoneMap& map);

/// Returns the limbs that a map lacks entirely or in part: `left arm`, `legs`, also `hips` and
/// `torso`; empty: complete. Clavicles, hands, toes, neck and head are not limbs here.
[[nodiscard]] std::vector<std::string> missing_parts(const BoneMap& map);

/// The sides are swapped if left_is_left, or the mean of leg_facing, is below minus this value.
inline constexpr double kMinSwapEvidence = 0.1;

/// Evidence of a leg for the direction `front`: knees bend forwards, and toes point forwards.
/// @param thigh, shin  vectors between the joints, any length unit
/// @param foot   vector from the ankle to the tip of the foot; nearly zero: unknown
/// @param front  a unit vector
/// @return about 1: the front; about -1: the back; near 0: no evidence
[[nodiscard]] double leg_facing(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                                const Eigen::Vector3d& foot, const Eigen::Vector3d& front);

/// Evidence that the left side of a map is the left of the body. The front follows from toes and
/// knees, and left x up = front fails for a mirrored body.
/// @return about 1: correct; about -1: swapped; near 0: no evidence
[[nodiscard]] double left_is_left(const BodySource& source, const BoneMap& map);

/// A joint whose name may mean a bone.
struct NamedJoint {
  int joint;
  double weight;  ///< Confidence in the name, at most 1.
};

/// One bone of a limb, and its candidate joints.
struct LimbSlot {
  Bone bone;
  bool required;
  std::vector<NamedJoint> choices;
};

/// An assignment of joints to the slots of a limb.
struct LimbChoice {
  std::vector<int> joints;  ///< One per slot, or -1.
  double weight = 0.0;      ///< Sum of the names' weights.
  std::vector<std::string> notes;
};

/// Returns the best assignment of joints to slots, in line from the body outwards. For equal merit,
/// the upper joints win. If joints on separate branches fit a required bone equally well, this is
/// an error; for an optional bone, the joint closest to their centre is taken, with a note.
[[nodiscard]] Result<LimbChoice> choose_limb(const BodySource& source,
                                             const std::vector<LimbSlot>& slots);

/// Error: two joints fit a bone equally well.
[[nodiscard]] Failure ambiguous_bone(const BodySource& source, Bone bone, int a, int b);

/// Note for users: any of several joints could be the bone.
[[nodiscard]] std::string note_of_choice(const BodySource& source, Bone bone,
                                         const std::vector<int>& joints, int chosen);

/// Returns the joint closest to the centre of several candidates; for equal distances, the first.
[[nodiscard]] int middle_joint(const BodySource& source, const std::vector<int>& joints);

/// Two chains of joints of equal lengths that leave a body on either side.
struct ChainPair {
  std::vector<int> left, right;  ///< Joints from the body outwards, of equal size; which is left is
                                 ///< undecided.
  std::vector<double> lengths;   ///< Mean distance of a joint from the previous one.
  double reach = 0.0;            ///< Sum of `lengths`.
};

/// Distances along the tree and longest paths from a joint through each neighbour.
class TreeReach {
 public:
  explicit TreeReach(const BodySource& source);

  /// Returns the distance between neighbours.
  [[nodiscard]] double edge(int a, int b) const { return lengths_[tree_.parent(a) == b ? a : b]; }
  /// Returns the length of the longest path from `from` through its neighbour `by`; end sites are
  /// included.
  [[nodiscard]] double reach(int from, int by) const;
  /// Returns the length of the longest path of the tree.
  [[nodiscard]] double diameter() const;

 private:
  const SkeletonTree& tree_;
  const std::vector<double>& lengths_;
  std::vector<double> down_;  // From a joint to the farthest one below it.
  std::vector<double> up_;    // From a joint to the farthest one not below it.
};

/// The longest pair of equal chains that leave a joint, not through its neighbour `avoid`. Pairs of
/// similar length that begin with another joint count as rivals.
struct BestPair {
  ChainPair pair;
  double rival_reach = 0.0;  ///< Reach of the longest other pair; 0: none.
};
[[nodiscard]] BestPair longest_mirrored_pair(const BodySource& source, const TreeReach& reach,
                                             int joint, int avoid);

}  // namespace retarget
