#pragma once

#include <optional>
#include <string>

#include "console.h"
#include "options.h"
#include "retarget/motion.h"

namespace retarget::cli {

/// Warns of what the formats that the options name cannot hold of a motion: PBHC's files have fewer
/// joints, SOMA's no rate but 120 frames a second and what divides it.
void warn_of_losses(const OutputOptions& options, const RobotClip& motion, Console& console);

}  // namespace retarget::cli
