#pragma once

// Support for tests of binary formats: a sink that keeps frames, and their poses in the world.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/stream_formats.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/robot.h"

namespace retarget {

inline const StreamFormat& format_of(const std::string& name) {
  return *find_stream_format(name).value();
}
inline std::unique_ptr<Decoder> stream_decoder(const std::string& format,
                                               const StreamAddress& from = {}) {
  return format_of(format).decoder(from);
}
inline std::unique_ptr<Encoder> stream_encoder(const std::string& format) {
  return format_of(format).encoder();
}

class KeptStream final : public StreamSink {
 public:
  void take_skeleton(Clip clip, bool has_rest) override {
    skeletons.push_back(std::move(clip));
    rests.push_back(has_rest);
  }
  void take_frame(const StreamFrame& frame) override { frames.push_back(frame); }

  // World poses of a frame, with the latest skeleton or another one.
  [[nodiscard]] std::vector<Pose> world(std::size_t frame) const {
    return world(frame, skeletons.back().shared_skeleton());
  }
  [[nodiscard]] std::vector<Pose> world(std::size_t frame,
                                        const std::shared_ptr<const Skeleton>& skeleton) const {
    Clip clip(skeleton, FrameRate{}, 1);
    std::ranges::copy(frames.at(frame).rotations, clip.rotations(0).begin());
    std::ranges::copy(frames.at(frame).translations, clip.translations(0).begin());
    std::vector<Pose> poses(static_cast<std::size_t>(skeleton->joint_count()));
    forward_kinematics(clip, 0, poses);
    return poses;
  }

  std::vector<Clip> skeletons;
  std::vector<bool> rests;
  std::vector<StreamFrame> frames;
};

/// The message with which a decoder rejects a packet.
inline std::string refusal_of(Decoder& decoder, std::string_view bytes) {
  KeptStream kept;
  const auto taken = decoder.take(bytes, kept);
  EXPECT_FALSE(taken);
  return taken ? std::string() : taken.error().message;
}

/// A text of an OSC packet.
inline std::string osc_text(std::string text) {
  text.append(4 - text.size() % 4, '\0');
  return text;
}

inline const LoadedRobot& streamed_g1() {
  static const LoadedRobot robot =
      load_robot({"unitree_g1", {}, {}, {}}, DataFolder{RETARGET_SOURCE_DIR}).value();
  return robot;
}

inline Clip sample_clip(const std::string& name) {
  return load_clip(RETARGET_SOURCE_DIR "/data/" + name + ".bvh").value();
}

// Expects the pose of a G1 that follows a person who faces a z that is -y here, with the left arm
// down and the right arm held out.
inline void expect_left_arm_down(const Robot& robot, std::span<const double> qpos) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, qpos, world_from_body);
  const auto place = [&](const char* body) {
    return world_from_body[static_cast<std::size_t>(robot.find_body(body).value())].translation;
  };
  const Eigen::Vector3d left = place("left_wrist_yaw_link"), right = place("right_wrist_yaw_link");
  EXPECT_LT(left.z(), right.z() - 0.2);
  EXPECT_GT(left.x(), 0.05);
  EXPECT_LT(right.x(), -0.2);
  const Eigen::Quaterniond root(qpos[3], qpos[4], qpos[5], qpos[6]);
  EXPECT_LT((root * Eigen::Vector3d::UnitX()).y(), -0.95);
  EXPECT_NEAR((root * Eigen::Vector3d::UnitZ()).z(), 1.0, 0.05);
}

// Metres and radians, the larger one.
inline double distance(const Pose& a, const Pose& b) {
  return std::max((a.translation - b.translation).norm(), a.rotation.angularDistance(b.rotation));
}

}  // namespace retarget
