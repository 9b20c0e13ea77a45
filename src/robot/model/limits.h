#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/faults.h"
#include "retarget/motion.h"
#include "retarget/robot.h"

namespace retarget {

/// Reads a limit set from `{"joint": [lower, upper], ...}`; other joints keep the model's ranges.
/// @param what  describes the ranges in error messages.
[[nodiscard]] LimitSet ranges_from_json(const nlohmann::ordered_json& json, const Robot& robot,
                                        const std::string& what, Faults& faults);

/// Position of a hinge, rad, that is rather in degrees: more than 1.5 turns from zero.
inline constexpr double kLikeDegrees = 10.0;

/// Whether a position of a hinge looks like degrees: more than kLikeDegrees from zero, and not in a
/// range that the model itself states.
/// @param joint  index into Robot::joints().
[[nodiscard]] bool looks_like_degrees(const Robot& robot, std::size_t joint, double position);

/// Minimum distance of a motion from its joint limits.
struct LimitDistance {
  std::string joint;             ///< The joint that comes closest to a limit or exceeds it most.
  int frame = 0;                 ///< First frame in which it does.
  bool at_upper = false;         ///< True for the upper limit, false for the lower.
  double distance = 0.0;         ///< Distance from the limit, rad or m; negative beyond it.
  double frames_at_limit = 0.0;  ///< Fraction of frames with a joint within kAtLimit of a limit.
};

/// A joint closer than this to a limit (rad or m) counts as being at it.
inline constexpr double kAtLimit = 1e-3;

/// Finds the joint position closest to a limit. Ignores joints that stay at the zero configuration,
/// such as unused fingers, and locked joints, whose range is a single value. Returns nothing for a
/// clip without frames or if no remaining joint is limited.
[[nodiscard]] std::optional<LimitDistance> nearest_limit(const RobotClip& clip,
                                                         const LimitSet& limits);

}  // namespace retarget
