#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

inline constexpr std::size_t kG1Joints = 29;
inline constexpr std::size_t kDex3Motors = 7;

/// Indices into qpos of the joints that controllers of Unitree's G1 use.
struct G1Joints {
  std::array<std::size_t, kG1Joints> mujoco{};  ///< Order of Unitree's models and motors.
  std::array<std::size_t, kG1Joints> isaac{};   ///< Isaac Lab's order (tracking_layout).
  /// Hand joints in the order of the Dex3's motors: thumb, middle, index; for the right hand thumb,
  /// index, middle (Dex3_1_Left_JointIndex and Dex3_1_Right_JointIndex of Unitree's
  /// xr_teleoperate). Empty if the robot has none or its variant holds them.
  std::optional<std::array<std::size_t, kDex3Motors>> left_hand, right_hand;
};

/// Errors (kUsage): the robot is not a G1 with all joints.
/// @param who  name of the controller, for the message.
[[nodiscard]] Result<G1Joints> find_g1_joints(const Robot& robot, std::string_view who);

}  // namespace retarget
