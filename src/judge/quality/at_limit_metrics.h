#pragma once

#include "judge/quality/joint_demand.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/robot.h"

namespace retarget {

/// Measures the share of the upright frames in which joints are at a limit, and finds the joint
/// with the most such frames: separately for frames in which the human's pose demands the limit,
/// and for the others. Adds no metric if the body is never upright.
/// @param limits  joint ranges.
/// @param demand  null: unknown; no frame then counts as demanded.
void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits, const Posture& posture,
                       JointDemand* demand);

}  // namespace retarget
