#pragma once

#include <memory>
#include <string>

#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// load_robot_motion with what the sidecar beside a CSV records of it (`walk.csv.json` beside
/// `walk.csv`): rate, units, order of the quaternion and variant, which a CSV without a header
/// cannot tell. Options that are given go first. A sidecar counts only where its hash is that of
/// the file's content; one of another content is said and left alone, and anything else under
/// its name is none.
[[nodiscard]] Result<RobotMotion> load_recorded_motion(const std::string& path,
                                                       const std::shared_ptr<const Robot>& robot,
                                                       const ReadMotionOptions& options);

/// How a run's motion is read: where it is a robot's (SourceOptions::from_robot), what the sidecar
/// beside a CSV records goes in where the options leave it open.
[[nodiscard]] SourceOptions recorded_source(const std::string& path, SourceOptions options);

/// The robot's variant that the sidecar beside a CSV records; empty: none, or the sidecar does not
/// count.
[[nodiscard]] std::string recorded_variant(const std::string& path);

}  // namespace retarget
