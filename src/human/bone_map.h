#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "human/bones.h"
#include "retarget/clip.h"

namespace retarget {

/// Bones a source joint can stand for: kBoneNames without the two synthetic feet.
inline constexpr int kMappedBoneCount = kBoneCount - 2;

/// What all files of a kind of skeleton have in common. Files are converted and edited, so that
/// these count where the clip itself does not speak against them.
struct SkeletonFacts {
  std::optional<double> height;           ///< Of every body of this kind, metres.
  std::optional<double> metres_per_unit;  ///< Of lengths.
  std::optional<Eigen::Vector3d> up;      ///< Unit vector, file axes.
  /// What is known of the rest pose: `canonical` (all bones have LAFAN1's axes: nothing to
  /// calibrate), `zero` or `first` (all rotations zero, the first frame: a T-pose), `learned` (no
  /// pose of it is one); empty: nothing.
  std::string rest_pose;
};

/// Which joint of a source skeleton stands for each canonical bone.
struct BoneMap {
  std::string dialect;      ///< Name of the dialect file, or "names", "topology", "map file".
  double confidence = 0.0;  ///< 0..1.
  /// Joint index per canonical bone of kBoneNames[0..21]; -1: the source has none. The spine:
  /// Hips is the joint both legs hang from, Spine2 the torso, i.e. the last common ancestor of the
  /// arms; Spine and Spine1 the joints between (fewer: -1; more: chosen evenly, the rest folded).
  std::array<int, kMappedBoneCount> joint_of_bone = none();
  std::vector<std::string> notes;  ///< For people: what is missing, folded, assumed.
  bool partial = false;            ///< Legs or arms are missing.
  SkeletonFacts facts;             ///< Of the dialect; empty where none was recognised.

  /// The joint of a bone by its canonical name; -1: the source has none.
  [[nodiscard]] int joint(std::string_view bone) const {
    return joint_of_bone[static_cast<std::size_t>(find_bone(bone).value())];
  }

 private:
  static constexpr std::array<int, kMappedBoneCount> none() {
    std::array<int, kMappedBoneCount> joints{};
    joints.fill(-1);
    return joints;
  }
};

/// The joint whose rotation turns a bone.
///
/// That is the bone's own joint, except on the way from the hips up to the file's root where the
/// root is not at the hips (a headset, for one): there the tree runs against the body, and the
/// joint that turns the part of the body between two joints is the one farther from the hips. And
/// where helpers stand in the joint's own place, without a length between: all that the bone
/// carries hangs from the last of them, which holds the turns of those before.
/// @return -1 for a bone without a joint.
[[nodiscard]] int rotation_joint(const BoneMap& map, const Skeleton& skeleton,
                                 std::string_view bone);

}  // namespace retarget
