#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "formats/robot_motion/raw_motion.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Evidence for each of the two orders of four quaternion columns.
struct OrderEvidence {
  double upright[2] = {0.0, 0.0};  ///< Mean z component of the root's z axis, by QuaternionOrder.
  double slip[2] = {0.0, 0.0};     ///< Mean slip of the lowest point, metres per frame.
  /// The same if the file has y up.
  double upright_if_y_up[2] = {0.0, 0.0};
  double slip_if_y_up[2] = {0.0, 0.0};
};

/// The chosen order and the reason; no order if the evidence is inconclusive.
struct OrderGuess {
  std::optional<QuaternionOrder> order;
  bool by_habit = false;  ///< Both orders fit; the usual one is chosen.
  std::string reason;
};

/// Evaluates the motion with both orders.
/// @param configurations  in RobotClip's layout, metres and radians; root rotations are ignored.
[[nodiscard]] OrderEvidence weigh_orders(const RobotClip& configurations, const RawMotion& raw);

/// Chooses the order in which the robot stands along y if its feet then slip much less than along z
/// in either order; otherwise the order in which the robot stands upright; otherwise the one whose
/// feet slip less. If the robot stands upright and hardly moves in both, chooses the usual order.
/// (The dot product of consecutive quaternions is the same for both orders, so continuity of the
/// rotation alone proves nothing; continuity of the standing foot is.)
[[nodiscard]] OrderGuess guess_order(const OrderEvidence& evidence, QuaternionOrder usual);

/// Chooses the order in which the root has the rotation of the robot's fixed base in every frame.
/// If both fit, chooses the usual one; if none fits, returns no order.
[[nodiscard]] OrderGuess order_of_fixed_base(const Robot& robot, const RawMotion& raw);

/// A point of a robot that may touch the floor.
struct TouchPoint {
  int body;
  Eigen::Vector3d place;  ///< In the body's frame, metres.
};

/// The points of the soles, or the body origins if the robot has no soles.
[[nodiscard]] std::vector<TouchPoint> touch_points(const Robot& robot);

}  // namespace retarget
