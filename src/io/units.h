#pragma once

#include <string>

#include "io/raw_motion.h"

namespace retarget {

/// Decides which units a motion is in: RawMotion::degrees and metres_per_unit are set afterwards.
///
/// Options count, then what the file says. What says nothing is in our own dialect's radians and
/// metres, however odd: a guess by magnitude would turn a robot on a roof into one that lies on the
/// ground. Evidence against them is an error or a warning, and never another unit.
///
/// @param rate  of the motion.
/// @param raw   its numbers are finite and its joint_indices known.
/// Errors (kInput): joints beyond the robot's widest range, a root beyond its reach.
[[nodiscard]] Result<void> find_units(const Robot& robot, const FrameRate& rate,
                                      const std::string& file, const ReadMotionOptions& options,
                                      RawMotion& raw);

}  // namespace retarget
