#pragma once

#include "quality/draft.h"
#include "retarget/robot.h"

namespace retarget {

/// In how many frames joints stand at a limit, and which one most.
void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits);

}  // namespace retarget
