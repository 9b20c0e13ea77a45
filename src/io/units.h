#pragma once

#include <string>
#include <vector>

#include "io/raw_motion.h"
#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"

namespace retarget {

/// Decides which units a motion is in: RawMotion::degrees and metres_per_unit are set afterwards.
///
/// Options count, then what the file says. What says nothing is in our own dialect's radians and
/// metres, however odd: a guess by magnitude would turn a robot on a roof into one that lies on the
/// ground. Evidence against them is an error or a warning, and never another unit.
///
/// @param raw  its numbers are finite and its joint_indices known.
/// Errors (kInput): joints beyond the robot's widest range (those that have none: beyond four turns),
/// a root beyond its reach.
[[nodiscard]] Result<void> find_units(const Robot& robot, const std::string& file,
                                      const ReadMotionOptions& options, RawMotion& raw);

/// Whether a motion whose file names no unit of length can be in metres, as it was taken. Asked
/// last, as the order of the quaternion must be known: who lies may be low, who stands may not.
///
/// @param warnings  doubts are added.
/// Errors (kInput): a root that is upright and all but on the ground, with feet far below it, as
/// ten and a hundred times too small a motion has them.
[[nodiscard]] Result<void> check_assumed_metres(const RobotClip& clip, const std::string& file,
                                                std::vector<std::string>& warnings);

}  // namespace retarget
