#pragma once

#include <span>
#include <string>

#include "arguments.h"
#include "console.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "run/outputs.h"

namespace retarget::cli {

/// The reader's options as the command line has them.
/// @param memory_gb  that a motion may take; 0: as there is.
[[nodiscard]] ReadMotionOptions read_motion_options(const ReadingOptions& options,
                                                    double memory_gb);

/// Says what a file was taken for, and what is odd about it.
/// @param rate_option  that tells the rate where the file does not.
void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option = "--source-fps");

/// Warns of what the formats of files cannot hold of a motion.
void warn_of_losses(const RobotClip& motion, std::span<const WrittenFile> files, Console& console);

}  // namespace retarget::cli
