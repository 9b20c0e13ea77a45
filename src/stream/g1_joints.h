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

/// Where controllers of Unitree's G1 find their numbers in a configuration; indices into qpos.
struct G1Joints {
  std::array<std::size_t, kG1Joints> mujoco{};  ///< In the order of Unitree's models and motors.
  std::array<std::size_t, kG1Joints> isaac{};   ///< In Isaac Lab's (tracking_layout).
  /// Of a hand in the order of the Dex3's motors: thumb, middle, index; of the right one thumb, index,
  /// middle (Dex3_1_Left_JointIndex and Dex3_1_Right_JointIndex of Unitree's xr_teleoperate).
  /// Empty: the robot has none, or its variant holds them.
  std::optional<std::array<std::size_t, kDex3Motors>> left_hand, right_hand;
};

/// Errors (kUsage): a robot that is no G1 with all its joints.
/// @param who  reads the numbers, for the message.
[[nodiscard]] Result<G1Joints> find_g1_joints(const Robot& robot, std::string_view who);

}  // namespace retarget
