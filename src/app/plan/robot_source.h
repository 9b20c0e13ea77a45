#pragma once

#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// A robot whose motions are a source, and the configuration that defines its bones.
struct SourceRobot {
  LoadedRobot loaded;
  ResolvedConfig config;  ///< The configuration that a fit to this robot uses.
};

/// @return kConfig errors: an unknown robot, errors in its files, no configuration
[[nodiscard]] Result<SourceRobot> load_source_robot(const std::string& name,
                                                    const DataFolder& data_folder);

/// Like load_clip, for a robot's motion.
[[nodiscard]] Result<Clip> load_robot_clip(const std::string& file, const SourceOptions& options,
                                           const DataFolder& data_folder);

/// Reject options for humans with a robot as source (kUsage), and the reverse.
[[nodiscard]] Result<void> check_robot_source(const SourceOptions& options);
[[nodiscard]] Result<void> check_human_of_robot(const HumanOptions& options);

/// Fit options for a robot's motion. Its body rotations are known, whereas a human's are only
/// estimated from limb lines, so they weigh 2.5 times as much. To keep the gates satisfied
/// (docs/robot_to_robot.md), velocity changes and contacts with the floor weigh more, too.
[[nodiscard]] FitOptions fit_of_robot_motions(FitOptions fit);

}  // namespace retarget
