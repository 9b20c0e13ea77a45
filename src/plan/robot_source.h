#pragma once

#include <string>

#include "base/option_name.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// A robot whose motions are a source, and what tells its bones.
struct SourceRobot {
  LoadedRobot loaded;
  ResolvedConfig config;  ///< The one that a fit to this robot takes.
};

/// Errors (kConfig): an unknown robot, errors in its files, no configuration.
[[nodiscard]] Result<SourceRobot> load_source_robot(const std::string& name,
                                                    const DataFolder& data_folder);

/// load_clip of a robot's motion.
[[nodiscard]] Result<Clip> load_robot_clip(const std::string& file, const SourceOptions& options,
                                           const DataFolder& data_folder);

/// Options that are about humans where the source is a robot (kUsage), and the other way round.
[[nodiscard]] Result<void> check_robot_source(const SourceOptions& options);
[[nodiscard]] Result<void> check_human_of_robot(const HumanOptions& options);

/// The fit's options for a robot's motion: its bodies' rotations are known, and what lines of limbs tell of a human
/// is only a guess of them, so they count 2.5 times as much. So that gates stay where they were (docs/robot_to_robot.md),
/// velocities change more slowly and what rests on the floor counts more, too.
[[nodiscard]] FitOptions fit_of_robot_motions(FitOptions fit);

/// What a user is told whose file may be that of a robot's motion.
inline constexpr const char* kFromRobotHint =
    "if it is a robot's motion, " OPTION("from-robot") " NAME says whose, such as unitree_g1";

}  // namespace retarget
