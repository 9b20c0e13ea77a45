#include "live/stream/controller_messages.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "retarget/bytes.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
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

constexpr std::string_view kTopic = "pose";
constexpr std::size_t kHeaderSize = 1280;
constexpr double kFps = 50.0;
constexpr int kMaxFrames = 100;

// Shifts the values to make room for the next frame at the end.
template <typename T>
void shift(std::vector<T>& values, std::size_t width) {
  std::move(values.begin() + static_cast<std::ptrdiff_t>(width), values.end(), values.begin());
}

std::string header_of(std::size_t frames, std::size_t joints, bool left_hand, bool right_hand) {
  const auto field = [](std::string_view name, std::string_view type,
                        const std::vector<std::size_t>& shape) {
    return nlohmann::ordered_json{{"name", name}, {"dtype", type}, {"shape", shape}};
  };
  auto fields = nlohmann::ordered_json::array(
      {field("joint_pos", "f32", {frames, joints}), field("joint_vel", "f32", {frames, joints}),
       field("body_quat", "f32", {frames, 4}), field("frame_index", "i64", {frames})});
  if (left_hand) fields.push_back(field("left_hand_joints", "f32", {kDex3Motors}));
  if (right_hand) fields.push_back(field("right_hand_joints", "f32", {kDex3Motors}));
  const nlohmann::ordered_json header = {
      {"v", 1}, {"endian", "le"}, {"count", frames}, {"fields", fields}};
  std::string text = header.dump();
  text.resize(kHeaderSize, '\0');
  return text;
}

using Eigen::Quaterniond;
using Eigen::Vector3d;

double roll_of(const Quaterniond& q) {
  return atan2(2.0 * (q.w() * q.x() + q.y() * q.z()), 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y()));
}

double pitch_of(const Quaterniond& q) {
  const double sine = std::clamp(2.0 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0);
  return atan2(sine, std::sqrt((1.0 - sine) * (1.0 + sine)));
}

void copy_hand(const std::optional<std::array<std::size_t, kDex3Motors>>& joints,
               std::span<const double> qpos, std::array<double, kDex3Motors>& hand) {
  for (std::size_t i = 0; joints && i < hand.size(); ++i) hand[i] = qpos[(*joints)[i]];
}

// Errors (kUsage): the robot is not a G1 with all joints.
// @param who  name of the controller, for the message.
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

}  // namespace

Result<SonicMessage> SonicMessage::make(const Robot& robot, double fps,
                                        const SonicOptions& options) {
  if (fps != kFps) {
    return usage_failure(
        fmt::format("SONIC plays {} frames per second, found {}", kFps, number_text(fps, 3)),
        "omit " RETARGET_OPTION("fps"));
  }
  if (options.frames < 1 || options.frames > kMaxFrames) {
    return usage_failure(
        fmt::format("a SONIC message has 1 to {} frames, found {}", kMaxFrames, options.frames));
  }
  SonicMessage made;
  made.fps_ = fps;
  made.frames_ = static_cast<std::size_t>(options.frames);
  if (options.any_robot) {
    for (const int joint : tracking_layout(robot, MotionFormat::kCsvSonic).joints) {
      made.joints_.push_back(
          static_cast<std::size_t>(robot.joints()[static_cast<std::size_t>(joint)].qpos_address));
    }
  } else {
    RETARGET_TRY_ASSIGN(const G1Joints g1, find_g1_joints(robot, "SONIC"));
    made.joints_.assign(g1.isaac.begin(), g1.isaac.end());
    made.left_hand_ = g1.left_hand;
    made.right_hand_ = g1.right_hand;
  }
  const std::size_t joints = made.joints_.size();
  made.positions_.resize(made.frames_ * joints);
  made.velocities_.resize(made.frames_ * joints);
  made.rotations_.resize(made.frames_ * 4);
  made.indices_.resize(made.frames_);
  made.previous_.resize(joints);
  made.message_ = std::string(kTopic) + header_of(made.frames_, joints, made.left_hand_.has_value(),
                                                  made.right_hand_.has_value());
  made.payload_ = made.message_.size();
  // Reserve the maximum size, so that take() does not allocate.
  made.message_.reserve(made.payload_ + made.frames_ * (8 * joints + 16 + 8) + 8 * kDex3Motors);
  return made;
}

std::string_view SonicMessage::take(const RobotFrame& frame) {
  // Frames of another session have no history.
  if (known_ > 0 && frame.index != indices_.back() + 1) known_ = 0;
  add(frame);
  if (known_ < frames_) return {};
  write();
  write_hand(left_hand_, frame.qpos);
  write_hand(right_hand_, frame.qpos);
  return message_;
}

void SonicMessage::add(const RobotFrame& frame) {
  const std::size_t joints = joints_.size(), last = frames_ - 1;
  shift(positions_, joints);
  shift(velocities_, joints);
  shift(rotations_, 4);
  shift(indices_, 1);
  for (std::size_t i = 0; i < joints; ++i) {
    const double position = frame.qpos[joints_[i]];
    const double velocity = known_ == 0 ? 0.0 : (position - previous_[i]) * fps_;
    positions_[last * joints + i] = static_cast<float>(position);
    velocities_[last * joints + i] = static_cast<float>(velocity);
    previous_[i] = position;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    rotations_[last * 4 + i] = static_cast<float>(frame.qpos[3 + i]);
  }
  indices_.back() = frame.index;
  known_ = std::min(known_ + 1, frames_);
}

void SonicMessage::write() {
  message_.resize(payload_);
  for (const auto* values : {&positions_, &velocities_, &rotations_}) {
    for (const float value : *values) append_little_endian(message_, value);
  }
  for (const std::int64_t index : indices_) {
    append_little_endian(message_, static_cast<std::uint64_t>(index), 8);
  }
}

void SonicMessage::write_hand(const Hand& hand, std::span<const double> qpos) {
  if (!hand) return;
  for (const std::size_t address : *hand)
    append_little_endian(message_, static_cast<float>(qpos[address]));
}

Result<Twist2Actions> Twist2Actions::make(const Robot& robot, double fps) {
  Twist2Actions made;
  RETARGET_TRY_ASSIGN(made.joints_, find_g1_joints(robot, "TWIST2"));
  made.fps_ = fps;
  return made;
}

const Twist2Action& Twist2Actions::take(const RobotFrame& frame) {
  const auto qpos = frame.qpos;
  const Root root = {frame.index, Vector3d(qpos[0], qpos[1], qpos[2]),
                     root_rotation(qpos).normalized()};
  // Frames of another session have no history.
  if (!previous_ || root.index != previous_->index + 1) previous_ = root;
  const Quaterniond root_from_world = root.world_from_root.conjugate();
  const Vector3d velocity = fps_ * (root_from_world * (root.position - previous_->position));
  const Vector3d turn = log_so3(root.world_from_root * previous_->world_from_root.conjugate());
  const Vector3d turning_rate = fps_ * (root_from_world * turn);
  action_.body[0] = velocity.x();
  action_.body[1] = velocity.y();
  action_.body[2] = root.position.z();
  action_.body[3] = roll_of(root.world_from_root);
  action_.body[4] = pitch_of(root.world_from_root);
  action_.body[5] = turning_rate.z();
  for (std::size_t i = 0; i < kG1Joints; ++i) action_.body[6 + i] = qpos[joints_.mujoco[i]];
  copy_hand(joints_.left_hand, qpos, action_.left_hand);
  copy_hand(joints_.right_hand, qpos, action_.right_hand);
  previous_ = root;
  return action_;
}

}  // namespace retarget
