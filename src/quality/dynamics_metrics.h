#pragma once

#include "quality/draft.h"

namespace retarget {

/// What the motion asks of the robot by inverse dynamics, and what contacts can supply of it. Left
/// out for a robot without mass, and for fewer than three frames.
void measure_dynamics(const ReportBuilder& draft);

}  // namespace retarget
