#pragma once

#include <span>
#include <vector>

#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"

namespace retarget {

/// Angles between a segment of the robot and the same segment of the human.
struct SegmentAngles {
  bool is_upper_arm = false;   ///< False: a line of the trunk.
  std::vector<double> angles;  ///< Angles by frame, degrees.
};

/// Measures `arm_jolts`: how often an upper arm that cannot reach its target direction turns the
/// trunk abruptly away from the human's, or back. The cause is a shoulder at a limit, on a wrong
/// branch of the inverse kinematics. Excludes frames in which the human lies, because the floor
/// moves arms and trunk there.
/// @param segments  upper arms and lines of the trunk, all with the same number of frames.
void measure_arm_jolts(const ReportBuilder& draft, const Posture& posture,
                       std::span<const SegmentAngles> segments);

}  // namespace retarget
