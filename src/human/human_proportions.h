#pragma once

#include "human/candidate.h"

namespace retarget {

/// Why a body is no human's, such as `the legs are shorter than the trunk`; empty: it may be one.
///
/// Signs are a trunk longer than the legs, arms as long as the legs, names of animals' parts, and a
/// trunk that is never in line with the legs in a motion. One sign is no proof; two are.
[[nodiscard]] std::vector<std::string> signs_against_human(const BodySource& source,
                                                           const BoneMap& map);

inline constexpr std::size_t kSignsThatProve = 2;

}  // namespace retarget
