#pragma once

#include "human/candidate.h"

namespace retarget {

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

}  // namespace retarget
