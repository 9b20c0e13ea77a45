#pragma once

#include <span>
#include <vector>

#include "judge/quality/report_parts.h"

namespace retarget {

/// Angles between a segment of the human and of the robot, by frame, degrees.
struct SegmentAngles {
  bool is_upper_arm = false;  ///< Otherwise a line of the trunk.
  std::vector<double> angles;
};

/// Counts the times at which an upper arm that cannot reach its direction pulls the trunk along: the
/// trunk turns away from the human, or back, abruptly. This happens when a shoulder runs into its
/// limits on a wrong branch of the inverse kinematics.
void measure_arm_jolts(const ReportBuilder& draft, std::span<const SegmentAngles> segments);

}  // namespace retarget
