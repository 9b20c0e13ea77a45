#pragma once

#include "retarget/robot/robot_clip.h"

namespace retarget {

/// Heading of a body: the angle about z from the world's x axis to the body's, seen from above;
/// for a body whose x axis points nearly up or down, the twist of its rotation about z. Radians.
[[nodiscard]] double heading(const Eigen::Quaterniond& world_from_body);

/// Moves and turns a motion as a whole so that its first frame has the root at x = y = 0 and
/// heading 0. Heights and everything relative stay.
void normalize_start(RobotClip& clip);

}  // namespace retarget
