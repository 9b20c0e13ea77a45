#pragma once

#include "human/candidate.h"

namespace retarget {

/// What speaks against a body being a human's.
struct HumanDoubts {
  std::vector<std::string> signs;  ///< Such as `the legs are shorter than the trunk`.
  bool proven = false;             ///< Enough signs that it is none.
};

/// Signs are a trunk longer than the legs, arms as long as the legs, names of animals' parts, and a
/// trunk that never rises over the legs in a motion. Two prove it; of a body that is seen to stand,
/// which may be a cartoon's, three.
[[nodiscard]] HumanDoubts doubt_human(const BodySource& source, const BoneMap& map);

}  // namespace retarget
