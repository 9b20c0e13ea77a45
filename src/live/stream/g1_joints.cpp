#include "live/stream/g1_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Names = std::array<std::string_view, kG1Joints>;
using Motors = std::array<std::string_view, kDex3Motors>;

constexpr Names kNames = {
    "left_hip_pitch",     "left_hip_roll",     "left_hip_yaw",         "left_knee",
    "left_ankle_pitch",   "left_ankle_roll",   "right_hip_pitch",      "right_hip_roll",
    "right_hip_yaw",      "right_knee",        "right_ankle_pitch",    "right_ankle_roll",
    "waist_yaw",          "waist_roll",        "waist_pitch",          "left_shoulder_pitch",
    "left_shoulder_roll", "left_shoulder_yaw", "left_elbow",           "left_wrist_roll",
    "left_wrist_pitch",   "left_wrist_yaw",    "right_shoulder_pitch", "right_shoulder_roll",
    "right_shoulder_yaw", "right_elbow",       "right_wrist_roll",     "right_wrist_pitch",
    "right_wrist_yaw"};

constexpr Motors kLeftMotors = {"thumb_0",  "thumb_1", "thumb_2", "middle_0",
                                "middle_1", "index_0", "index_1"};
constexpr Motors kRightMotors = {"thumb_0", "thumb_1",  "thumb_2", "index_0",
                                 "index_1", "middle_0", "middle_1"};

// Index into the robot's joints, if the robot outputs the joint.
std::optional<int> find_moving_joint(const Robot& robot, const std::string& name) {
  const auto joint = robot.find_joint(name);
  if (!joint || std::ranges::count(robot.output_joints(), *joint) == 0) return std::nullopt;
  return joint;
}

std::size_t address_of(const Robot& robot, int joint) {
  return static_cast<std::size_t>(robot.joints()[static_cast<std::size_t>(joint)].qpos_address);
}

std::optional<std::array<std::size_t, kDex3Motors>> find_hand(const Robot& robot,
                                                              std::string_view side,
                                                              const Motors& motors) {
  std::array<std::size_t, kDex3Motors> hand{};
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const auto joint = find_moving_joint(robot, fmt::format("{}_hand_{}_joint", side, motors[i]));
    if (!joint) return std::nullopt;
    hand[i] = address_of(robot, *joint);
  }
  return hand;
}

}  // namespace

Result<G1Joints> find_g1_joints(const Robot& robot, std::string_view who) {
  G1Joints found;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const std::string name = fmt::format("{}_joint", kNames[i]);
    const auto joint = find_moving_joint(robot, name);
    if (!joint) {
      return usage_failure(fmt::format("{} reads the {} joints of Unitree's G1, but {} has no {}",
                                       who, kG1Joints, robot.name(), name),
                           "choose " RETARGET_OPTION(
                               "robot") " unitree_g1 or unitree_g1_with_hands, with all joints");
    }
    found.mujoco[i] = address_of(robot, *joint);
  }
  std::size_t next = 0;
  for (const int joint : tracking_layout(robot, MotionFormat::kCsvSonic).joints) {
    const std::size_t address = address_of(robot, joint);
    if (std::ranges::count(found.mujoco, address) > 0) found.isaac[next++] = address;
  }
  found.left_hand = find_hand(robot, "left", kLeftMotors);
  found.right_hand = find_hand(robot, "right", kRightMotors);
  return found;
}

}  // namespace retarget
