#pragma once

#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/robot.h"

namespace retarget {

/// Measures in how many of the upright frames joints are at a limit, and which joint most often.
/// Adds nothing if the body is never upright.
void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits, const Posture& posture);

}  // namespace retarget
