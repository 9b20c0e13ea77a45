#pragma once

#include <optional>
#include <string>

#include "io/raw_motion.h"
#include "retarget/motion.h"
#include "retarget/options.h"

namespace retarget {

/// What tells the two readings of four quaternion columns apart.
struct OrderEvidence {
  double upright[2] = {0.0, 0.0};  ///< Mean height of the root's z axis, by QuaternionOrder.
  double slip[2] = {0.0, 0.0};     ///< Mean way of the lowest point in a frame, metres.
};

/// What was decided, and why; no order: it cannot be told.
struct OrderGuess {
  std::optional<QuaternionOrder> order;
  bool by_habit = false;  ///< Both readings do: the usual one was taken.
  std::string reason;
};

/// Reads the root both ways.
/// @param configurations  RobotClip's layout, metres and radians; the rotation is not looked at.
[[nodiscard]] OrderEvidence weigh_orders(const RobotClip& configurations, const RawMotion& raw);

/// Of both readings the one that stands upright; else the one whose feet slip less; where both
/// stand upright and hardly move, the usual one. (The dot product of neighbouring quaternions is the
/// same for both readings, so that continuity of the rotation alone tells nothing; that of the
/// standing foot does.)
[[nodiscard]] OrderGuess guess_order(const OrderEvidence& evidence, QuaternionOrder usual);

}  // namespace retarget
