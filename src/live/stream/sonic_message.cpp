#include "live/stream/sonic_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "retarget/bytes.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

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

}  // namespace retarget
