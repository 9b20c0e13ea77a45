#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/human/bones.h"

namespace retarget {

/// Bones a source joint can stand for: kBoneNames without the two synthetic feet.
inline constexpr int kMappedBoneCount = kBoneCount - 2;

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

}  // namespace retarget
