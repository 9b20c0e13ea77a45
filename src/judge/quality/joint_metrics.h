#pragma once

#include "judge/quality/draft.h"
#include "retarget/robot.h"

namespace retarget {

/// Measures limits, speeds, jumps and accelerations of the output joints, and the root's jerk.
void measure_joints(const ReportBuilder& draft, const LimitSet& limits);

}  // namespace retarget
