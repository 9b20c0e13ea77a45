#pragma once

#include <array>
#include <vector>

#include "human/gait/end_tracks.h"
#include "human/gait/planted_parts.h"

namespace retarget {

/// Likelihood that each foot end stands, by end and frame, from quantities that do not depend on the
/// root.
/// @param falls    frames_in_free_fall()
/// @param turning  turning speed above which a foot hardly stands, m/s
[[nodiscard]] std::array<std::vector<double>, kEndCount> stance_likelihood(
    const EndTracks& tracks, const std::vector<char>& falls, const PlantedParts& parts,
    double turning);

}  // namespace retarget
