#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"
#include "stream/g1_joints.h"

namespace retarget {

/// What TWIST2's controller reads of a frame.
struct Twist2Action {
  /// Velocity of the root along its x and y, m/s; its height, m; roll and pitch, rad; turning rate
  /// about its z, rad/s; 29 joints in MuJoCo's order, rad.
  std::array<double, 6 + kG1Joints> body{};
  std::array<double, kDex3Motors> left_hand{}, right_hand{};  ///< rad; 0, open: it has none.
  std::array<double, 2> neck{};  ///< Yaw and pitch, rad: 0, as the G1 has none.
};

/// Robot frames as TWIST2 reads them from Redis (redis_output.h).
///
/// Follows TWIST2 (amazon-far/TWIST2), deploy_real/xrobot_teleop_to_robot_w_hand.py: what
/// extract_mimic_obs_whole_body computes and send_to_redis sends. Roll and pitch are those of
/// world_from_root = Rz(yaw) Ry(pitch) Rx(roll). Velocities are differences to the frame before, in the
/// axes that the root has now; those of the first frame are 0.
class Twist2Actions {
 public:
  /// Errors (kUsage): a robot that is no G1.
  [[nodiscard]] static Result<Twist2Actions> make(const Robot& robot, double fps);

  /// Takes the next frame. Nothing is allocated.
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
