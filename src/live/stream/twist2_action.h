#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "live/stream/g1_joints.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"

namespace retarget {

/// The values that TWIST2's controller reads for a frame.
struct Twist2Action {
  /// Root velocity along its x and y axes, m/s; root height, m; roll and pitch, rad; yaw rate about
  /// its z axis, rad/s; 29 joints in MuJoCo's order, rad.
  std::array<double, 6 + kG1Joints> body{};
  std::array<double, kDex3Motors> left_hand{}, right_hand{};  ///< Rad; 0 (open) without hands.
  std::array<double, 2> neck{};  ///< Yaw and pitch, rad; 0, as the G1 has no neck.
};

/// Converts robot frames to the values that TWIST2 reads from Redis (redis_output.h).
///
/// Follows TWIST2 (amazon-far/TWIST2), deploy_real/xrobot_teleop_to_robot_w_hand.py:
/// extract_mimic_obs_whole_body and send_to_redis. Roll and pitch refer to world_from_root =
/// Rz(yaw) Ry(pitch) Rx(roll). Velocities are backward differences in the root's current axes;
/// those of the first frame are 0.
class Twist2Actions {
 public:
  /// Errors (kUsage): the robot is not a G1.
  [[nodiscard]] static Result<Twist2Actions> make(const Robot& robot, double fps);

  /// Converts the next frame. Does not allocate.
  [[nodiscard]] const Twist2Action& take(const RobotFrame& frame);

 private:
  struct Root {
    std::int64_t index = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Quaterniond world_from_root = Eigen::Quaterniond::Identity();
  };

  G1Joints joints_;
  double fps_ = 0.0;
  std::optional<Root> previous_;
  Twist2Action action_;
};

}  // namespace retarget
