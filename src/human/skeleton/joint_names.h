#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// A joint name without differences between exporters.
struct JointName {
  Side side = Side::kNone;
  std::string base;  ///< Lower case, without separators; numbers without leading zeros.

  bool operator==(const JointName&) const = default;
};

/// Normalises the joint names of one skeleton.
///
/// Removes namespaces (`mixamorig:`, `Armature|`), prefixes of well-known exporters (`Bip01`,
/// `Character1_`), and words that nearly all names begin or end with. `Left`, `L_`, `_l`, `.L`,
/// `lShldr` and similar marks become the side: `Bip01 L Thigh` is {left, "thigh"}. Centre marks
/// (`C_Head`) are removed.
[[nodiscard]] std::vector<JointName> normalise_joint_names(const std::vector<std::string>& names);

/// A bone that a word may name. The weight is 1 if the word has no other meaning.
struct WordMeaning {
  Bone bone;  ///< Spine for all joints of the spine.
  double weight;
};

/// Returns the bones that a normalised name may mean: `shoulder` is the clavicle or the upper arm,
/// `leg` the thigh or the shin. Names of fingers, twist joints, ends and helpers mean none.
[[nodiscard]] std::vector<WordMeaning> meanings_of(const JointName& name);

/// Returns whether a name may mean a canonical bone.
[[nodiscard]] bool may_mean(const JointName& name, Bone bone);

/// Returns whether a name means a canonical bone with little ambiguity.
[[nodiscard]] bool plainly_means(const JointName& name, Bone bone);

/// Returns whether a word names a limb part when it follows a side.
[[nodiscard]] bool is_limb_word(std::string_view base);

/// Returns a normalised name without its trailing number.
[[nodiscard]] std::string_view without_number(std::string_view base);

/// Returns whether a name refers to an animal: tail, paw, wing.
[[nodiscard]] bool is_animal_word(std::string_view base);

}  // namespace retarget
