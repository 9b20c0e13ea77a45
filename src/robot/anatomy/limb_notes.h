#pragma once

#include <optional>

#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Observations in the zero configuration.
struct ZeroPose {
  double lean = 0.0;       ///< Lean of the line from hips to shoulders, degrees.
  std::optional<int> toe;  ///< Joint excluded at the end of the left leg, if any.
};

/// Adds unusual decisions to RobotAnatomy::notes.
void note_limbs(const Robot& robot, const ZeroPose& zero, RobotAnatomy& found);

/// Adds ambiguous knees and elbows to RobotAnatomy::doubts: another joint fits nearly as well, or
/// one segment is shorter than 0.4 of the other.
void doubt_limbs(const Robot& robot, RobotAnatomy& found);

}  // namespace retarget
