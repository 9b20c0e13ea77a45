#pragma once

#include "human/gait/contact_plan.h"
#include "judge/quality/report_parts.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// Measures slip, drift and height of the robot's knees, elbows, hands, seat and back while those
/// of the source rest on the floor; 0 if they never do. Adds nothing for a robot without shapes
/// there.
void measure_supports(const ReportBuilder& draft, const ResolvedConfig& config,
                      const ContactPlan& contacts);

}  // namespace retarget
