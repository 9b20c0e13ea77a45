#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"
#include "stream/g1_joints.h"

namespace retarget {

struct SonicOptions {
  /// Latest frames in each message. A receiver that misses a message begins its motion anew where
  /// frames are missing, so messages overlap; 5 is what SONIC's own sender takes.
  int frames = 5;
  bool any_robot = false;  ///< All joints of whatever robot, for a deployment of its own.
};

/// Robot frames as SONIC's deployment reads them over ZeroMQ: protocol version 1, joint by joint.
///
/// `pose`, a JSON header padded with zeros to 1280 bytes, then its fields one after the other, little
/// endian: joint_pos and joint_vel [N, 29] (float32, rad and rad/s, Isaac Lab's order), body_quat
/// [N, 4] (float32, world_from_root w x y z), frame_index [N] (int64); of a robot with fingers
/// left_hand_joints and right_hand_joints [7] (float32, rad, of the latest frame). Velocities are
/// differences to the frame before, as nothing later is known; those of the first frame are 0.
///
/// Follows NVlabs/GR00T-WholeBodyControl: docs/source/tutorials/zmq.md ("Stream Protocol Versions") for
/// the fields, gear_sonic_deploy/.../input_interface/zmq_packed_message_subscriber.hpp ("Wire Format")
/// for the bytes, streamed_motion_merger.hpp for what becomes of frames that were missed.
class SonicMessage {
 public:
  /// @param fps  of the robot frames: SONIC plays 50 a second.
  /// Errors (kUsage): a robot that is no G1, unless any is wanted; another rate; frames out of range.
  [[nodiscard]] static Result<SonicMessage> make(const Robot& robot, double fps,
                                                 const SonicOptions& options = {});

  /// Takes the next frame.
  /// @return the message, valid until the next call; empty until there are as many frames as it has.
  ///     Nothing is allocated.
  [[nodiscard]] std::string_view take(const RobotFrame& frame);

 private:
  using Hand = std::optional<std::array<std::size_t, kDex3Motors>>;

  void add(const RobotFrame& frame);
  void write();
  void write_hand(const Hand& hand, std::span<const double> qpos);

  double fps_ = 0.0;
  std::size_t frames_ = 0;           // N
  std::vector<std::size_t> joints_;  // into qpos
  Hand left_hand_, right_hand_;

  // of the latest frames, the oldest first
  std::vector<float> positions_, velocities_, rotations_;
  std::vector<std::int64_t> indices_;
  std::size_t known_ = 0;         // of them
  std::vector<double> previous_;  // positions of the latest frame
  std::size_t payload_ = 0;       // where it begins
  std::string message_;
};

}  // namespace retarget
