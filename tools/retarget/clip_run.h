#pragma once

#include <filesystem>
#include <memory>

#include "console.h"
#include "options.h"
#include "retarget/base/result.h"
#include "retarget/pipeline/ik_tables.h"
#include "retarget/robot/limits.h"
#include "retarget/robot/robot.h"

namespace retarget::cli {

/// What is loaded once, however many clips go to the robot.
struct RobotSetup {
  std::shared_ptr<const Robot> robot;
  LimitSet limits;
  IkTables tables;
};

/// Robot, limits and mapping as the options name them.
[[nodiscard]] Result<RobotSetup> load_robot_setup(const RunOptions& options,
                                                  const std::filesystem::path& data_folder,
                                                  Console& console);

/// One clip from its file to the files that the options name: the motion, the report. Ctrl-C stops
/// between two frames and leaves nothing behind.
[[nodiscard]] Result<void> run_clip(const RunOptions& options, const RobotSetup& setup,
                                    const std::filesystem::path& data_folder, Console& console);

}  // namespace retarget::cli
