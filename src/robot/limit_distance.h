#pragma once

#include <optional>
#include <string>

#include "retarget/motion.h"
#include "retarget/robot.h"

namespace retarget {

/// How near a motion comes to the limits of its joints.
struct LimitDistance {
  std::string joint;      ///< The joint that comes nearest to a limit, or goes farthest beyond.
  int frame = 0;          ///< The first frame where it does.
  bool at_upper = false;  ///< Which of its two limits.
  double distance = 0.0;  ///< From the limit, rad or m; negative: beyond it.
  double frames_at_limit = 0.0;  ///< Share of frames with a joint within kAtLimit of a limit.
};

/// A joint this near to a limit (rad or m) is said to be at it.
inline constexpr double kAtLimit = 1e-3;

/// Joints that stay at the zero configuration, as fingers do that nothing moves, and joints with a
/// range of one value, which are held, do not count. Nothing for a clip without frames or where no
/// joint that counts is limited.
[[nodiscard]] std::optional<LimitDistance> nearest_limit(const RobotClip& clip,
                                                         const LimitSet& limits);

}  // namespace retarget
