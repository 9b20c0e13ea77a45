#pragma once

#include <vector>

#include "judge/quality/body_tracks.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/measure.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// The bodies whose poses measure_tracking() uses: the root and the bodies of the tables, without
/// duplicates.
[[nodiscard]] std::vector<int> tracked_bodies(const ResolvedConfig& config);

/// Measures the tracking errors of bodies (by row of the configuration), limbs, trunk and root.
/// @param tracks  contains the poses of tracked_bodies().
/// @param limits  joint ranges.
/// @param frames  number of frames that motion and source share.
void measure_tracking(const ReportBuilder& draft, const BodyTracks& tracks,
                      const QualitySource& source, const LimitSet& limits, const Posture& posture,
                      int frames);

}  // namespace retarget
