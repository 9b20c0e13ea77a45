#pragma once

#include "human/candidate.h"

namespace retarget {

/// What speaks against a body being a human's.
struct HumanDoubts {
  std::vector<std::string> signs;  ///< Such as `the legs are shorter than the trunk`.
  bool proven = false;             ///< Enough signs that it is none.
};

/// Signs are a trunk longer than the legs, arms as long as the legs, names of animals' parts, and in a
/// motion a trunk that lies across the legs most of the time; then also narrow shoulders, feet as long
/// as segments of legs, and single chains that hang from both head and hips. Two prove it (a trunk across
/// and narrow shoulders do not, which broken motions have); of a body
/// that is seen to stand or lie stretched, which may be a cartoon's, three. People who crawl have
/// one of them.
[[nodiscard]] HumanDoubts doubt_human(const BodySource& source, const BoneMap& map);

}  // namespace retarget
