#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "options.h"
#include "outputs.h"
#include "retarget/error.h"
#include "retarget/ik_config.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "run_setup.h"

namespace retarget::cli {

/// What is loaded once, however many clips go to the robot.
struct RobotSetup {
  std::shared_ptr<const Robot> robot;
  LimitSet limits;
  RobotMappings mappings;
};

/// What one clip is solved with.
struct ClipSetup {
  std::shared_ptr<const Robot> robot;
  LimitSet limits;
  ResolvedMapping tables;  ///< Of the robot's mappings the one for this source.
};

/// Options of robot, method and time that contradict each other are kUsage errors.
[[nodiscard]] Result<void> check_solving_options(const RunOptions& options);

/// Robot, limits and mappings as the options name them.
[[nodiscard]] Result<RobotSetup> load_robot_setup(const RunOptions& options,
                                                  const std::filesystem::path& data_folder,
                                                  Console& console);

/// What became of a clip.
struct ClipOutcome {
  int frames = 0;                        ///< Of the motion that was written,
  double fps = 0.0;                      ///< and its rate.
  std::string mapping;                   ///< The mapping's file.
  std::vector<WrittenFile> motions;      ///< The motion's files, with their hashes.
  std::vector<std::string> others;       ///< Sidecars and the report.
  std::optional<QualityReport> quality;  ///< Where it was asked for.
};

/// Whether a run writes its files or makes their hashes alone.
enum class Writing : unsigned char { kFiles, kHashes };

/// One clip from its file to the files that the options name: the motion, sidecars, the report.
/// Ctrl-C stops between two frames and leaves nothing behind.
[[nodiscard]] Result<ClipOutcome> run_clip(const RunOptions& options, const RobotSetup& setup,
                                           const std::filesystem::path& data_folder,
                                           Console& console, Writing writing = Writing::kFiles);

}  // namespace retarget::cli
