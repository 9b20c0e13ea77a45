#pragma once

#include "judge/quality/joint_demand.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/robot.h"

namespace retarget {

/// Measures in how many of the upright frames joints are at a limit, and which joint most often:
/// against what the human's pose demands, and because of it. Adds nothing if the body is never
/// upright.
/// @param demand  null: unknown, so that all frames count as against it.
void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits, const Posture& posture,
                       const JointDemand* demand);

}  // namespace retarget
