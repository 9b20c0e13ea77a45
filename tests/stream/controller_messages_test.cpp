// Messages of robot frames for controllers, against closed forms; tests/cli/live_outputs_test.py
// tests their delivery.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "live/stream/controller_messages.h"
#include "live/stream/frame_output.h"
#include "retarget/load.h"
#include "support/counted_allocations.h"
#include "support/value_of.h"

namespace retarget {
namespace {

constexpr double kFps = 50.0;

std::shared_ptr<const Robot> robot_of(const std::string& name, const std::string& dof = {}) {
  RobotChoice choice;
  choice.name = name;
  choice.variant = dof;
  auto loaded = value_of(load_robot(choice, DataFolder{RETARGET_SOURCE_DIR}));
  return loaded.robot;
}

// Each joint has a different position.
std::vector<double> numbered(const Robot& robot, double factor) {
  std::vector<double> qpos(static_cast<std::size_t>(robot.configuration_size()));
  for (std::size_t i = 7; i < qpos.size(); ++i) qpos[i] = factor * static_cast<double>(i);
  qpos[3] = 1.0;
  return qpos;
}

double position_of(const Robot& robot, std::span<const double> qpos, const std::string& joint) {
  const auto found = robot.find_joint(joint + "_joint");
  EXPECT_TRUE(found) << joint;
  return qpos[static_cast<std::size_t>(
      robot.joints()[static_cast<std::size_t>(found.value_or(0))].qpos_address)];
}

RobotFrame frame_of(std::int64_t index, std::span<const double> qpos) {
  return {index, static_cast<double>(index) / kFps, LiveState::kFollowing, qpos};
}

// The numbers of a field.
template <typename T>
std::vector<T> field(std::string_view message, const std::string& name) {
  const nlohmann::json header = nlohmann::json::parse(message.substr(4, message.find('\0') - 4));
  std::size_t begin = 4 + 1280;
  for (const auto& described : header.at("fields")) {
    std::size_t count = 1;
    for (const std::size_t size : described.at("shape")) count *= size;
    const std::size_t size = described.at("dtype") == "i64" ? 8 : 4;
    if (described.at("name") == name) {
      EXPECT_EQ(size, sizeof(T));
      std::vector<T> values(count);
      std::memcpy(values.data(), message.data() + begin, count * size);
      return values;
    }
    begin += count * size;
  }
  return {};
}

TEST(SonicMessages, HaveIsaacLabsOrder) {
  // Isaac Lab's joint order of the G1.
  const std::vector<std::string> order = {
      "left_hip_pitch",       "right_hip_pitch",  "waist_yaw",         "left_hip_roll",
      "right_hip_roll",       "waist_roll",       "left_hip_yaw",      "right_hip_yaw",
      "waist_pitch",          "left_knee",        "right_knee",        "left_shoulder_pitch",
      "right_shoulder_pitch", "left_ankle_pitch", "right_ankle_pitch", "left_shoulder_roll",
      "right_shoulder_roll",  "left_ankle_roll",  "right_ankle_roll",  "left_shoulder_yaw",
      "right_shoulder_yaw",   "left_elbow",       "right_elbow",       "left_wrist_roll",
      "right_wrist_roll",     "left_wrist_pitch", "right_wrist_pitch", "left_wrist_yaw",
      "right_wrist_yaw"};
  for (const char* name : {"unitree_g1", "unitree_g1_with_hands"}) {
    const auto robot = robot_of(name);
    auto message = value_of(SonicMessage::make(*robot, kFps, {1, false}));
    const auto qpos = numbered(*robot, 0.01);
    const auto positions = field<float>(message.take(frame_of(0, qpos)), "joint_pos");
    ASSERT_EQ(positions.size(), order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      EXPECT_EQ(positions[i], static_cast<float>(position_of(*robot, qpos, order[i]))) << order[i];
    }
  }
}

TEST(SonicMessages, OverlapAndHaveVelocities) {
  const auto robot = robot_of("unitree_g1");
  auto message = value_of(SonicMessage::make(*robot, kFps, {3, false}));
  for (std::int64_t i = 0; i < 6; ++i) {
    // A joint moves by 0.01 * its number per frame, so its speed is 50 times that.
    auto qpos = numbered(*robot, 0.01 * static_cast<double>(i));
    qpos[3] = std::cos(0.05 * static_cast<double>(i));
    qpos[6] = std::sin(0.05 * static_cast<double>(i));
    const std::string_view bytes = message.take(frame_of(i, qpos));
    ASSERT_EQ(bytes.empty(), i < 2) << i;
    if (bytes.empty()) continue;
    EXPECT_EQ(bytes.size(), 4 + 1280 + 3 * (2 * 29 * 4 + 4 * 4 + 8));
    EXPECT_EQ(field<std::int64_t>(bytes, "frame_index"),
              (std::vector<std::int64_t>{i - 2, i - 1, i}));
    const auto velocities = field<float>(bytes, "joint_vel");
    // The hip pitch is number 7 of a configuration.
    for (std::size_t row = 0; row < 3; ++row) {
      const bool first = i - 2 + static_cast<std::int64_t>(row) == 0;
      EXPECT_NEAR(velocities[29 * row], first ? 0.0 : 0.01 * 7 * kFps, 1e-5);
    }
    const auto rotations = field<float>(bytes, "body_quat");
    EXPECT_FLOAT_EQ(rotations[8], static_cast<float>(qpos[3]));
    EXPECT_FLOAT_EQ(rotations[11], static_cast<float>(qpos[6]));
  }
}

TEST(SonicMessages, RestartWithANewSession) {
  const auto robot = robot_of("unitree_g1");
  auto message = SonicMessage::make(*robot, kFps, {2, false});
  ASSERT_TRUE(message);
  EXPECT_TRUE(message->take(frame_of(7, numbered(*robot, 0.0))).empty());
  EXPECT_FALSE(message->take(frame_of(8, numbered(*robot, 0.0))).empty());
  // No velocity across the gap, and no message with frames of both sides.
  EXPECT_TRUE(message->take(frame_of(0, numbered(*robot, 1.0))).empty());
  const std::string_view bytes = message->take(frame_of(1, numbered(*robot, 1.0)));
  for (const float velocity : field<float>(bytes, "joint_vel")) EXPECT_EQ(velocity, 0.0F);
}

TEST(SonicMessages, OrderHandsByTheirMotors) {
  const auto robot = robot_of("unitree_g1_with_hands");
  auto message = SonicMessage::make(*robot, kFps);
  auto actions = Twist2Actions::make(*robot, kFps);
  ASSERT_TRUE(message && actions);
  const auto qpos = numbered(*robot, 0.01);
  std::string bytes;
  for (int i = 0; i < 5; ++i) bytes = message->take(frame_of(i, qpos));
  const Twist2Action& action = actions->take(frame_of(0, qpos));
  const auto check = [&](const std::string& side, const std::vector<std::string>& motors,
                         const std::array<double, 7>& hand) {
    const auto values = field<float>(bytes, side + "_hand_joints");
    ASSERT_EQ(values.size(), motors.size());
    for (std::size_t i = 0; i < motors.size(); ++i) {
      std::string name = side;
      name.append("_hand_").append(motors[i]);
      EXPECT_EQ(hand[i], position_of(*robot, qpos, name));
      EXPECT_EQ(values[i], static_cast<float>(hand[i]));
    }
  };
  check("left", {"thumb_0", "thumb_1", "thumb_2", "middle_0", "middle_1", "index_0", "index_1"},
        action.left_hand);
  check("right", {"thumb_0", "thumb_1", "thumb_2", "index_0", "index_1", "middle_0", "middle_1"},
        action.right_hand);
  // Held fingers are omitted.
  auto without = SonicMessage::make(*robot_of("unitree_g1_with_hands", "29"), kFps, {1, false});
  ASSERT_TRUE(without);
  EXPECT_TRUE(field<float>(without->take(frame_of(0, qpos)), "left_hand_joints").empty());
}

TEST(SonicMessages, RequireAG1) {
  const auto h1 = robot_of("unitree_h1");
  EXPECT_EQ(SonicMessage::make(*h1, kFps).error().kind, ErrorKind::kUsage);
  EXPECT_EQ(Twist2Actions::make(*h1, kFps).error().kind, ErrorKind::kUsage);
  // 29 joints, but different ones.
  EXPECT_FALSE(SonicMessage::make(*robot_of("booster_t1_29dof"), kFps));
  EXPECT_FALSE(SonicMessage::make(*robot_of("unitree_g1", "23"), kFps));
  auto all = SonicMessage::make(*h1, kFps, {1, true});
  ASSERT_TRUE(all);
  EXPECT_EQ(field<float>(all->take(frame_of(0, numbered(*h1, 1.0))), "joint_pos").size(),
            h1->output_joints().size());
  const auto g1 = robot_of("unitree_g1");
  EXPECT_FALSE(SonicMessage::make(*g1, 30.0));
  EXPECT_FALSE(SonicMessage::make(*g1, kFps, {0, false}));
  EXPECT_FALSE(SonicMessage::make(*g1, kFps, {101, false}));
}

// Rotates about its own tilted axis while it moves along a line: all rates are known.
TEST(Twist2Actions, MatchASteadyTurn) {
  const auto robot = robot_of("unitree_g1");
  auto actions = Twist2Actions::make(*robot, kFps);
  ASSERT_TRUE(actions);
  const double rate = 1.3, roll = 0.2, pitch = -0.3;  // rad/s, rad
  const Eigen::Vector3d velocity(0.4, -0.7, 0.1);     // m/s, world
  auto qpos = numbered(*robot, 0.01);
  for (int i = 0; i < 40; ++i) {
    const double time = i / kFps;
    const Eigen::Matrix3d tilt = (Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
    const Eigen::Matrix3d world_from_root =
        Eigen::AngleAxisd(rate * time, Eigen::Vector3d::UnitZ()).toRotationMatrix() * tilt;
    const Eigen::Quaterniond q(world_from_root);
    const Eigen::Vector3d position = Eigen::Vector3d(0.0, 0.0, 0.8) + time * velocity;
    for (int k = 0; k < 3; ++k) qpos[k] = position[k];
    // A quaternion and its negative are the same rotation.
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    qpos[3] = sign * q.w();
    for (int k = 0; k < 3; ++k) qpos[4 + k] = sign * q.vec()[k];
    const Twist2Action& action = actions->take(frame_of(i, qpos));
    const bool first = i == 0;
    const Eigen::Vector3d local =
        first ? Eigen::Vector3d::Zero() : Eigen::Vector3d(world_from_root.transpose() * velocity);
    EXPECT_NEAR(action.body[0], local.x(), 1e-12);
    EXPECT_NEAR(action.body[1], local.y(), 1e-12);
    EXPECT_NEAR(action.body[2], position.z(), 1e-15);
    EXPECT_NEAR(action.body[3], roll, 1e-12);
    EXPECT_NEAR(action.body[4], pitch, 1e-12);
    // The component of the rotation about the world's z along the root's z.
    EXPECT_NEAR(action.body[5], first ? 0.0 : rate * std::cos(roll) * std::cos(pitch), 1e-11);
    EXPECT_EQ(action.body[6], position_of(*robot, qpos, "left_hip_pitch"));
    EXPECT_EQ(action.body[34], position_of(*robot, qpos, "right_wrist_yaw"));
    EXPECT_EQ(action.left_hand[0], 0.0);
  }
}

TEST(ControllerMessages, AllocateNothing) {
  const auto robot = robot_of("unitree_g1_with_hands");
  auto message = SonicMessage::make(*robot, kFps);
  auto actions = Twist2Actions::make(*robot, kFps);
  ASSERT_TRUE(message && actions);
  const auto qpos = numbered(*robot, 0.01);
  const long before = allocations;
  std::size_t bytes = 0;
  for (int i = 0; i < 20; ++i) {
    bytes += message->take(frame_of(i, qpos)).size();
    static_cast<void>(actions->take(frame_of(i, qpos)));
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(bytes, 0U);
}

TEST(FrameOutputs, AcceptOnlyTransportsOfTheirFormat) {
  const FrameOutputContext context = {robot_of("unitree_g1"), kFps, [](auto, auto) {}};
  for (const char* text : {"zmq:0?format=jsonl", "udp:9?format=sonic", "x.csv?format=twist2",
                           "redis:6379?format=sonic", "udp:9?format=sonc"}) {
    const auto opened = open_frame_output(parse_address(text).value(), context);
    ASSERT_FALSE(opened) << text;
    EXPECT_EQ(opened.error().kind, ErrorKind::kUsage) << text;
  }
}

}  // namespace
}  // namespace retarget
