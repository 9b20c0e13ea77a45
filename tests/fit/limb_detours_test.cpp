// Arms that run into the limits of the shoulder for a moment, or pass near its singularity.

#include "solve/fit/limb_detours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "support/arm_movement.h"

namespace retarget {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// The arms swing up and back, past the line through both shoulders, and return at once. Near this
// line the first and the third axis of a G1's shoulder are parallel.
// @param raised  degrees that are added to the highest pose.
Clip swing_past_the_shoulder_line(int frames_per_pose = 14, const FrameRate& rate = {30, 1},
                                  double raised = 0.0) {
  const std::array<ArmPose, 7> poses = {{{-60, 60, 10},
                                         {-60, 60, 10},
                                         {-10, 90, 10},
                                         {100 + raised, 120, 10},
                                         {-10, 90, 10},
                                         {-60, 60, 10},
                                         {-60, 60, 10}}};
  return arm_movement(poses, frames_per_pose, rate);
}

double largest_step(const RobotClip& clip) {
  double most = 0.0;
  for (int t = 1; t < clip.frame_count(); ++t) {
    for (std::size_t i = 7; i < clip.qpos(t).size(); ++i) {
      most = std::max(most, std::abs(clip.qpos(t)[i] - clip.qpos(t - 1)[i]));
    }
  }
  return most;
}

TEST(LimbDetours, FindsTheWayAroundTheShoulderLimits) {
  const Clip clip = swing_past_the_shoulder_line();
  const RobotCase robot = robot_case("unitree_g1");
  const auto plain = plainly_fitted(clip, robot);
  const auto recovered = fitted(clip, robot);
  ASSERT_TRUE(plain.has_value());
  ASSERT_TRUE(recovered.has_value());
  EXPECT_LT(recovered->report.status.cost_after, 0.5 * plain->report.status.cost_after);
  EXPECT_LT(largest_step(recovered->clip), 0.48);
  EXPECT_THAT(recovered->report.notes,
              Contains(HasSubstr("arm was stuck on a wrong branch in frames ")));
  for (int t = 0; t < 3; ++t) EXPECT_TRUE(same(plain->clip, recovered->clip, t)) << t;
}

// This robot's shoulders can follow the swing without a detour.
TEST(LimbDetours, NeverIncreasesTheCost) {
  const Clip clip = swing_past_the_shoulder_line();
  const RobotCase robot = robot_case("fourier_n1");
  const auto plain = plainly_fitted(clip, robot);
  const auto recovered = fitted(clip, robot);
  ASSERT_TRUE(plain.has_value());
  ASSERT_TRUE(recovered.has_value());
  EXPECT_LE(recovered->report.status.cost_after, plain->report.status.cost_after * (1.0 + 1e-9));
}

TEST(LimbDetours, IsIndependentOfTheFrameRate) {
  const RobotCase robot = robot_case("unitree_g1");
  for (const int factor : {1, 4}) {
    const Clip clip = swing_past_the_shoulder_line(14 * factor, {30 * factor, 1});
    const auto plain = plainly_fitted(clip, robot);
    const auto recovered = fitted(clip, robot);
    ASSERT_TRUE(plain.has_value());
    ASSERT_TRUE(recovered.has_value());
    EXPECT_LT(recovered->report.status.cost_after, 0.5 * plain->report.status.cost_after) << factor;
  }
}

// Joints on a detour move as fast as the fit allows without a cost. If they moved exactly that fast,
// rounding would decide which of them the fit's first step slows down.
TEST(LimbDetours, DoNotAmplifyRounding) {
  const RobotCase robot = robot_case("unitree_g1");
  const auto once = fitted(swing_past_the_shoulder_line(), robot);
  const auto again = fitted(swing_past_the_shoulder_line(14, {30, 1}, 1e-10), robot);
  ASSERT_TRUE(once.has_value());
  ASSERT_TRUE(again.has_value());
  ASSERT_THAT(once->report.notes, Contains(HasSubstr("branch")));
  double most = 0.0;
  for (int t = 0; t < once->clip.frame_count(); ++t) {
    for (std::size_t i = 7; i < once->clip.qpos(t).size(); ++i) {
      most = std::max(most, std::abs(once->clip.qpos(t)[i] - again->clip.qpos(t)[i]));
    }
  }
  EXPECT_LT(most, 1e-6);
}

// After the last frame, the arms need not return to the branch on which the fit left them.
TEST(LimbDetours, EndTheClipOnAnyBranch) {
  constexpr std::array<ArmPose, 4> kPoses = {
      {{-85, 90, 5}, {-25, 45, 90}, {30, 110, 70}, {60, 45, 20}}};
  const Clip clip = arm_movement(kPoses, 25);
  const RobotCase robot = robot_case("unitree_g1");
  const auto plain = plainly_fitted(clip, robot);
  const auto recovered = fitted(clip, robot);
  ASSERT_TRUE(plain.has_value());
  ASSERT_TRUE(recovered.has_value());
  EXPECT_LT(recovered->report.status.cost_after, 0.5 * plain->report.status.cost_after);
}

// Once one arm has moved, it no longer drags the trunk along, and the other arm is nearer to its
// targets.
TEST(LimbDetours, MoveSymmetricArmsAlike) {
  constexpr std::array<ArmPose, 5> kPoses = {
      {{-85, 90, 5}, {0, 90, 5}, {85, 90, 5}, {0, 90, 5}, {-85, 90, 5}}};
  const RobotCase robot = robot_case("unitree_g1");
  const auto recovered = fitted(arm_movement(kPoses), robot);
  ASSERT_TRUE(recovered.has_value());
  ASSERT_THAT(recovered->report.notes, Contains(HasSubstr("left arm")));
  EXPECT_THAT(recovered->report.notes, Contains(HasSubstr("right arm")));
  const auto position = [&](const std::string& joint, int t) {
    const auto& joints = robot.robot->joints();
    const auto found = std::ranges::find(joints, joint + "_joint", &RobotJoint::name);
    if (found == joints.end()) {
      ADD_FAILURE() << joint;
      return 0.0;
    }
    return recovered->clip.qpos(t)[static_cast<std::size_t>(found->qpos_address)];
  };
  const auto difference = [&](const std::string& joint, double mirrored, int t) {
    return std::abs(position("left_" + joint, t) - mirrored * position("right_" + joint, t));
  };
  double most = 0.0;
  for (int t = 0; t < recovered->clip.frame_count(); ++t) {
    most = std::max({most, difference("shoulder_pitch", 1.0, t),
                     difference("shoulder_roll", -1.0, t), difference("shoulder_yaw", -1.0, t)});
  }
  EXPECT_LT(most, 0.5);
}

TEST(LimbDetours, LeavesArmsWithinReachUnchanged) {
  // The same swing at half the height reaches no limit.
  constexpr std::array<ArmPose, 5> kPoses = {
      {{-60, 60, 10}, {-60, 60, 10}, {-20, 60, 10}, {-60, 60, 10}, {-60, 60, 10}}};
  const Clip clip = arm_movement(kPoses, 14);
  const RobotCase robot = robot_case("unitree_g1");
  const auto plain = plainly_fitted(clip, robot);
  const auto recovered = fitted(clip, robot);
  ASSERT_TRUE(plain.has_value());
  ASSERT_TRUE(recovered.has_value());
  EXPECT_THAT(recovered->report.notes, Not(Contains(HasSubstr("branch"))));
  for (int t = 0; t < clip.frame_count(); ++t) {
    EXPECT_TRUE(same(plain->clip, recovered->clip, t)) << t;
  }
}

TEST(LimbDetours, IsIndependentOfTheThreadCount) {
  const Clip clip = swing_past_the_shoulder_line();
  const RobotCase robot = robot_case("unitree_g1");
  FitOptions options;
  options.threads = 1;
  const auto one = fitted(clip, robot, options);
  options.threads = 3;
  const auto three = fitted(clip, robot, options);
  ASSERT_TRUE(one.has_value());
  ASSERT_TRUE(three.has_value());
  for (int t = 0; t < clip.frame_count(); ++t) EXPECT_TRUE(same(one->clip, three->clip, t)) << t;
}

}  // namespace
}  // namespace retarget
