#pragma once

#include "retarget/simulate.h"

namespace retarget {

/// Compares a simulated motion with its reference and fills the tracking errors of the report.
/// @param frames  number of frames to compare, from the first.
void set_errors(const RobotClip& reference, const RobotClip& simulated, int frames,
                SimulationReport& report);

}  // namespace retarget
