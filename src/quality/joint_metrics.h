#pragma once

#include "quality/draft.h"
#include "retarget/robot.h"

namespace retarget {

/// Limits, speeds, jumps and accelerations of the output joints, and the root's jerk.
void measure_joints(const ReportBuilder& draft, const LimitSet& limits);

}  // namespace retarget
