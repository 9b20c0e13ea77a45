#pragma once

#include <vector>

#include "quality/body_tracks.h"
#include "quality/draft.h"
#include "quality/measure.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// The bodies whose poses measure_tracking needs: those of the tables and the root, each once.
[[nodiscard]] std::vector<int> tracked_bodies(const ResolvedConfig& config);

/// How the bodies follow their bones, row by row, and the limbs the human's.
/// @param tracks  with tracked_bodies kept.
/// @param frames  of both.
void measure_tracking(const ReportBuilder& draft, const BodyTracks& tracks,
                      const QualitySource& source, int frames);

}  // namespace retarget
