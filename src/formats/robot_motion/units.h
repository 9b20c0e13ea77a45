#pragma once

#include <string>
#include <vector>

#include "formats/robot_motion/raw_motion.h"
#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"

namespace retarget {

/// Determines the units of a motion and sets RawMotion::degrees and metres_per_unit.
///
/// Options take precedence, then declarations in the file. Without either, the units are radians
/// and metres, however unusual the values are: a guess by magnitude would turn a robot on a roof
/// into one that lies on the ground. Contrary evidence gives an error or a warning, but never
/// another unit.
///
/// @param raw  its numbers are finite and its joint_indices are known.
/// Errors (kInput): joint positions beyond the robot's widest range (without a range: beyond four
/// turns), a root beyond its reach.
[[nodiscard]] Result<void> find_units(const Robot& robot, const std::string& file,
                                      const ReadMotionOptions& options, RawMotion& raw);

/// Checks whether a motion with an assumed unit of length can be in metres. It runs last because it
/// needs the quaternion order: a lying robot may be low, a standing one may not.
///
/// @param warnings  receives warnings about the unit.
/// Errors (kInput): an upright root almost on the ground with feet far below it, as in a motion
/// that is ten or a hundred times too small.
[[nodiscard]] Result<void> check_assumed_metres(const RobotClip& clip, const std::string& file,
                                                std::vector<std::string>& warnings);

}  // namespace retarget
