#pragma once

#include "human/contact_plan.h"
#include "quality/draft.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// Slip, drift and height of the robot's knees, elbows, hands, seat and back while those of the source lie on
/// the floor; 0 where they never do. Nothing of a robot without shapes there.
void measure_supports(const ReportBuilder& draft, const ResolvedConfig& config,
                      const ContactPlan& contacts);

}  // namespace retarget
