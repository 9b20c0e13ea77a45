#pragma once

#include <vector>

#include "judge/quality/body_tracks.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/measure.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// The bodies whose poses measure_tracking needs: those of the tables and the root, without
/// duplicates.
[[nodiscard]] std::vector<int> tracked_bodies(const ResolvedConfig& config);

/// Measures how the bodies follow their bones row by row, the limbs the human's limbs, and the root
/// its path.
/// @param tracks  contains the poses of tracked_bodies.
/// @param limits  limits of the joints.
/// @param frames  number of frames of both.
void measure_tracking(const ReportBuilder& draft, const BodyTracks& tracks,
                      const QualitySource& source, const LimitSet& limits, const Posture& posture,
                      int frames);

}  // namespace retarget
