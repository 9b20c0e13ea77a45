#pragma once

#include <Eigen/Geometry>
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

struct SonicOptions {
  /// Number of latest frames in each message. Messages overlap because a receiver that misses a
  /// message restarts its motion at the gap; SONIC's own sender uses 5.
  int frames = 5;
  bool any_robot = false;  ///< Send all joints of any robot, for a custom deployment.
};

/// Encodes robot frames for SONIC's deployment over ZeroMQ: protocol version 1, joint by joint.
///
/// A message is `pose`, a JSON header padded with zeros to 1280 bytes, then its fields in sequence,
/// little-endian: joint_pos and joint_vel [N, 29] (float32, rad and rad/s, Isaac Lab's order),
/// body_quat [N, 4] (float32, world_from_root w x y z), frame_index [N] (int64); for a robot with
/// fingers also left_hand_joints and right_hand_joints [7] (float32, rad, latest frame). Velocities
/// are backward differences because later frames are not known yet; those of the first frame are 0.
///
/// Follows NVlabs/GR00T-WholeBodyControl: docs/source/tutorials/zmq.md ("Stream Protocol Versions")
/// for the fields, gear_sonic_deploy/.../input_interface/zmq_packed_message_subscriber.hpp ("Wire
/// Format") for the bytes, streamed_motion_merger.hpp for the handling of missed frames.
class SonicMessage {
 public:
  /// @param fps  rate of the robot frames: SONIC plays 50 per second.
  /// Errors (kUsage): a robot other than the G1, unless any_robot is set; another rate; frames out
  /// of range.
  [[nodiscard]] static Result<SonicMessage> make(const Robot& robot, double fps,
                                                 const SonicOptions& options = {});

  /// Adds the next frame. Does not allocate.
  /// @return the message, valid until the next call; empty until enough frames have been added.
  [[nodiscard]] std::string_view take(const RobotFrame& frame);

 private:
  using Hand = std::optional<std::array<std::size_t, kDex3Motors>>;

  void add(const RobotFrame& frame);
  void write();
  void write_hand(const Hand& hand, std::span<const double> qpos);

  double fps_ = 0.0;
  std::size_t frames_ = 0;           // N
  std::vector<std::size_t> joints_;  // Indices into qpos.
  Hand left_hand_, right_hand_;

  // Latest frames, oldest first.
  std::vector<float> positions_, velocities_, rotations_;
  std::vector<std::int64_t> indices_;
  std::size_t known_ = 0;         // Number of valid frames.
  std::vector<double> previous_;  // Joint positions of the latest frame.
  std::size_t payload_ = 0;       // Offset of the payload.
  std::string message_;
};

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
