// Only the arms follow (Follow::kArms): for any movement of the operator's legs and trunk, the
// robot's legs and trunk stand still, and its arms move like the operator's relative to the chest.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "live/live_sample.h"
#include "retarget/human_skeleton.h"
#include "retarget/load_robot.h"

namespace retarget {
namespace {

constexpr double kSeconds = 3.9;  // Seconds of the shortest sample.

LiveOptions arms_options(LiveMode mode) {
  LiveOptions options;
  options.mode = mode;
  options.lag_s = 0.1;
  return options;
}

// A human who walks in a circle and leans, with the arm movement of this human.
HumanClip walking(HumanClip human) {
  for (int i = 0; i < human.frame_count; ++i) {
    const double time = human.rate.time_of(i);
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(0.9 * time, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(0.35 * std::sin(2.0 * time), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d place(1.2 * std::cos(0.7 * time), 1.2 * std::sin(0.7 * time),
                                -0.2 * std::abs(std::sin(3.0 * time)));
    for (Pose& pose : human.world_from_bone[static_cast<std::size_t>(i)]) {
      pose = Pose{turn, place} * pose;
    }
  }
  return human;
}

std::vector<std::vector<double>> followed(const Plan& plan, const HumanClip& human, LiveMode mode,
                                          double fps = 50.0) {
  LiveOptions options = arms_options(mode);
  options.fps = fps;
  LiveSession session = LiveSession::make(plan, options).value();
  auto frames = streamed(session, human);
  EXPECT_GT(frames.size(), static_cast<std::size_t>(fps * kSeconds)) << human.frame_count;
  EXPECT_EQ(session.statistics().teleports, 0);
  return frames;
}

TEST(LiveArms, LegsTrunkAndBaseStayStillForAnyMovement) {
  for (const char* name : {"walk", "turn_in_place", "squat", "get_up"}) {
    const Plan plan = sample_plan(name, Method::kFit, sample_robot_arms());
    const Robot& robot = *plan.robot.robot;
    const std::vector<double> standing = robot.zero_configuration();
    const auto held = locked_joints(robot, plan.limits);
    for (const LiveMode mode : {LiveMode::kFrame, LiveMode::kLag}) {
      double moved = 0.0;
      for (const auto& qpos : followed(plan, human_of(plan), mode)) {
        for (std::size_t k = 0; k < 7; ++k) ASSERT_EQ(qpos[k], standing[k]) << name << " " << k;
        for (const RobotJoint& joint : robot.joints()) {
          const auto at = static_cast<std::size_t>(joint.qpos_address);
          if (std::ranges::find(held, joint.name) != held.end()) {
            ASSERT_EQ(qpos[at], standing[at]) << name << " " << joint.name;
          } else {
            moved = std::max(moved, std::abs(qpos[at] - standing[at]));
          }
        }
      }
      EXPECT_GT(moved, 0.2) << name;
    }
  }
}

TEST(LiveArms, AreIndependentOfWalkingAndTurning) {
  for (const char* name : {"wave", "walk"}) {
    const Plan plan = sample_plan(name, Method::kFit, sample_robot_arms());
    const HumanClip human = human_of(plan);
    for (const LiveMode mode : {LiveMode::kFrame, LiveMode::kLag}) {
      // At the human's own rate nothing is interpolated; interpolation would follow chords during
      // turns.
      const double fps = plan.rate.fps();
      const auto standing = followed(plan, human, mode, fps);
      const auto about = followed(plan, walking(human), mode, fps);
      ASSERT_EQ(standing.size(), about.size());
      for (std::size_t i = 0; i < standing.size(); ++i) {
        for (std::size_t k = 0; k < standing[i].size(); ++k) {
          ASSERT_NEAR(about[i][k], standing[i][k], 1e-6) << name << ", frame " << i;
        }
      }
    }
  }
}

// Vector from shoulder to wrist of a human or robot arm.
struct ArmLine {
  Bone shoulder, wrist;
  const char *robot_shoulder, *robot_wrist;
};
constexpr std::array kArmLines = {
    ArmLine{Bone::kLeftArm, Bone::kLeftHand, "left_shoulder_roll_link", "left_wrist_roll_link"},
    ArmLine{Bone::kRightArm, Bone::kRightHand, "right_shoulder_roll_link",
            "right_wrist_roll_link"}};

TEST(LiveArms, WristsMatchTheOperatorsRelativeToTheChest) {
  const Plan plan = sample_plan("wave", Method::kFit, sample_robot_arms());
  const Robot& robot = *plan.robot.robot;
  const HumanClip human = walking(human_of(plan));
  LiveOptions options = arms_options(LiveMode::kFrame);
  options.fps = plan.rate.fps();
  options.limit_speeds = false;
  LiveSession session = LiveSession::make(plan, options).value();
  const auto frames = streamed(session, human);
  ASSERT_EQ(static_cast<int>(frames.size()), human.frame_count);
  const Eigen::Quaterniond chest_in_t_pose(canonical_t_pose(Bone::kSpine2));
  std::vector<Pose> world_from_body(robot.bodies().size());
  double sum = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const HumanPose& pose = human.world_from_bone[i];
    forward_kinematics(robot, frames[i], world_from_body);
    const Eigen::Quaterniond upright = chest_in_t_pose * pose[Bone::kSpine2].rotation.conjugate();
    for (const ArmLine& arm : kArmLines) {
      const Eigen::Vector3d expected =
          upright * (pose[arm.wrist].translation - pose[arm.shoulder].translation);
      const auto place = [&](const char* body) {
        return world_from_body[static_cast<std::size_t>(robot.find_body(body).value())].translation;
      };
      const Eigen::Vector3d found = place(arm.robot_wrist) - place(arm.robot_shoulder);
      const double angle =
          std::acos(std::clamp(expected.normalized().dot(found.normalized()), -1.0, 1.0));
      sum += angle;
      largest = std::max(largest, angle);
    }
  }
  RecordProperty("largest_angle", std::to_string(largest));
  EXPECT_LT(sum / (2.0 * static_cast<double>(frames.size())), 0.12);
  EXPECT_LT(largest, 0.35);
}

}  // namespace
}  // namespace retarget
