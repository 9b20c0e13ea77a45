#pragma once

#include "judge/quality/report_parts.h"
#include "retarget/robot.h"

namespace retarget {

/// Measures limits, speeds, jumps and accelerations of the output joints, and jerk and jumps of the
/// root.
/// @param limits  limit set of limit_pct; the other sets of the robot go to limit_sets.
void measure_joints(const ReportBuilder& draft, const LimitSet& limits);

/// Measures the accelerations of the root and, for a robot with mass, of the centre of mass.
void measure_body_accelerations(const ReportBuilder& draft);

}  // namespace retarget
