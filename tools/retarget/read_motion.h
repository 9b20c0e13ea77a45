#pragma once

#include <memory>
#include <string>

#include "arguments.h"
#include "console.h"
#include "retarget/motion_io.h"

namespace retarget::cli {

/// The reader's options as the command line has them.
/// @param memory_gb  that a motion may take; 0: as there is.
[[nodiscard]] ReadMotionOptions read_motion_options(const ReadingArguments& arguments,
                                                    double memory_gb);

/// load_robot_motion; of a folder it says what is wanted in its place.
[[nodiscard]] Result<RobotMotion> read_motion(const std::string& file,
                                              const std::shared_ptr<const Robot>& robot,
                                              const ReadMotionOptions& options);

/// Says what a file was taken for, and what is odd about it.
/// @param rate_option  that tells the rate where the file does not.
void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option = "--source-fps");

}  // namespace retarget::cli
