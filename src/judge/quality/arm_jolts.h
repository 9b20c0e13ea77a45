#pragma once

#include <span>
#include <vector>

#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"

namespace retarget {

/// Angles between a segment of the human and of the robot, by frame, degrees.
struct SegmentAngles {
  bool is_upper_arm = false;  ///< Otherwise a line of the trunk.
  std::vector<double> angles;
};

/// Counts the times at which an upper arm that cannot reach its direction pulls the trunk along: the
/// trunk turns away from the human, or back, abruptly. This happens when a shoulder runs into its
/// limits on a wrong branch of the inverse kinematics. Frames in which the human lies do not count:
/// the floor moves arms and trunk there.
void measure_arm_jolts(const ReportBuilder& draft, const Posture& posture,
                       std::span<const SegmentAngles> segments);

}  // namespace retarget
