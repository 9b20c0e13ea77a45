#pragma once

#include <span>
#include <string>

#include "app/run/outputs.h"
#include "arguments.h"
#include "console.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"

namespace retarget::cli {

/// Converts the command line's reading options.
/// @param memory_gb  memory limit for a motion; 0: the available memory.
[[nodiscard]] ReadMotionOptions read_motion_options(const ReadingOptions& options,
                                                    double memory_gb);

/// Prints how a file was interpreted, and its warnings.
/// @param rate_option  option that states the rate if the file does not.
void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option = "--source-fps");

/// Warns about motion data that the output formats cannot store.
void warn_of_losses(const RobotClip& motion, std::span<const WrittenFile> files, Console& console);

}  // namespace retarget::cli
