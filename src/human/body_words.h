#pragma once

#include <string_view>
#include <vector>

#include "human/joint_names.h"
#include "retarget/human.h"

namespace retarget {

/// A bone that a word names, and how well: 1 for a word that means nothing else.
struct WordMeaning {
  Bone bone;  ///< Any joint of the spine is Spine.
  double weight;
};

/// Bones that a normalised name may mean: `shoulder` the clavicle or the upper arm, `leg` the thigh
/// or the shin. Names of fingers, twist joints, ends and helpers mean none.
[[nodiscard]] std::vector<WordMeaning> meanings_of(const JointName& name);

/// Whether a name may mean a canonical bone.
[[nodiscard]] bool may_mean(const JointName& name, Bone bone);

/// Whether a name means a canonical bone and hardly any other.
[[nodiscard]] bool plainly_means(const JointName& name, Bone bone);

/// Whether a word names a part of a limb when a side stands in front of it.
[[nodiscard]] bool is_limb_word(std::string_view base);

/// A normalised name without the number at its end.
[[nodiscard]] std::string_view without_number(std::string_view base);

/// Whether a name speaks of an animal: tail, paw, wing.
[[nodiscard]] bool is_animal_word(std::string_view base);

}  // namespace retarget
