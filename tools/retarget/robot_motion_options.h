#pragma once

#include <memory>
#include <string>

#include "console.h"
#include "options.h"
#include "retarget/motion_io.h"

namespace retarget::cli {

/// The reader's options as the command line has them.
/// @param source  says how much memory a motion may take.
[[nodiscard]] Result<ReadMotionOptions> read_motion_options(const ReadingOptions& options,
                                                            const SourceOptions& source);

/// load_robot_motion; of a folder it says what is wanted in its place.
[[nodiscard]] Result<RobotMotion> read_motion(const std::string& file,
                                              const std::shared_ptr<const Robot>& robot,
                                              const ReadMotionOptions& options);

/// Says what a file was taken for, and what is odd about it.
/// @param rate_option  that tells the rate where the file does not.
void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option = "--source-fps");

}  // namespace retarget::cli
