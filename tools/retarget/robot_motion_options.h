#pragma once

#include <string>

#include "console.h"
#include "options.h"
#include "retarget/motion_io.h"

namespace retarget::cli {

/// The reader's options as the command line has them.
/// @param source  says how much memory a motion may take.
[[nodiscard]] Result<ReadMotionOptions> read_motion_options(const ReadingOptions& options,
                                                            const SourceOptions& source);

/// Says what a file was taken for, and what is odd about it.
/// @param rate_option  that tells the rate where the file does not.
void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option = "--source-fps");

/// Warns of what the formats that the options name cannot hold of a motion.
void warn_of_losses(const OutputOptions& options, const RobotClip& motion, Console& console);

}  // namespace retarget::cli
