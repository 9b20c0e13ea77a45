// Limbs on the wrong branch: motions in which the fit alone leaves them there.

#include "solve/fit/branch_recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "solve/fit/limb_solver.h"
#include "support/arm_movement.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Raised sideways over the head and lowered in front: the shoulder has two ways down.
Clip up_sideways_down_in_front() {
  return arm_movement(std::array<ArmPose, 6>{
      {{-85, 90, 5}, {0, 90, 5}, {88, 90, 5}, {60, 0, 60}, {0, 0, 90}, {-85, 60, 10}}});
}

TEST(BranchRecovery, MovesArmsToTheBranchThatTracks) {
  const Clip clip = up_sideways_down_in_front();
  for (const char* name : {"unitree_h1", "engineai_pm01"}) {
    SCOPED_TRACE(name);
    const RobotCase robot = robot_case(name);
    const auto plain = value_of(plainly_fitted(clip, robot));
    const auto recovered = value_of(fitted(clip, robot));
    EXPECT_THAT(plain.report.notes, Not(Contains(HasSubstr("branch"))));
    EXPECT_THAT(recovered.report.notes,
                Contains(HasSubstr("the left arm was stuck on a wrong branch in frames ")));
    EXPECT_THAT(recovered.report.notes,
                Contains(HasSubstr("the right arm was stuck on a wrong branch in frames ")));
    // Without recovery, the fit is wrong for about two of five seconds.
    EXPECT_LT(recovered.report.status.cost_after, 0.5 * plain.report.status.cost_after);
    const auto rotation = [](const FitReport& report) {
      return std::ranges::find(report.terms, "rotation", &FitTermReport::name)->after;
    };
    EXPECT_LT(rotation(recovered.report), 0.5 * rotation(plain.report));
    // The arms are free until they are up.
    for (int t = 0; t < 5; ++t) EXPECT_TRUE(same(plain.clip, recovered.clip, t)) << t;
  }
}

TEST(BranchRecovery, SolvesLongIntervalsInParts) {
  const Clip clip = up_sideways_down_in_front();
  const RobotCase robot = robot_case("unitree_h1");
  FitOptions options;
  options.window = 2.5;
  const auto recovered = value_of(fitted(clip, robot, options));
  const auto plain = value_of(plainly_fitted(clip, robot, options));
  EXPECT_LT(recovered.report.status.cost_after, 0.6 * plain.report.status.cost_after);
}

TEST(BranchRecovery, IsIndependentOfTheThreadCount) {
  const Clip clip = up_sideways_down_in_front();
  const RobotCase robot = robot_case("unitree_h1");
  FitOptions options;
  options.window = 2.5;
  options.threads = 1;
  const auto one = fitted(clip, robot, options);
  options.threads = 3;
  const auto three = fitted(clip, robot, options);
  for (int t = 0; t < clip.frame_count(); ++t) EXPECT_TRUE(same(one->clip, three->clip, t)) << t;
}

// The removal of crossings between frames may, because the cost does not include them.
TEST(BranchRecovery, NeverIncreasesTheCost) {
  FitOptions options;
  options.self_collision = false;
  const std::array clips = {
      arm_movement(
          std::array<ArmPose, 4>{{{120, 30, 40}, {120, 30, 40}, {0, 90, 20}, {-80, 60, 15}}}),
      arm_movement(
          std::array<ArmPose, 4>{{{-80, 20, 15}, {0, 0, 15}, {100, 10, 15}, {190, 10, 15}}}),
  };
  for (const char* name : {"unitree_g1", "stanford_toddy"}) {
    const RobotCase robot = robot_case(name);
    for (const Clip& clip : clips) {
      SCOPED_TRACE(name);
      const auto plain = plainly_fitted(clip, robot, options);
      const auto recovered = fitted(clip, robot, options);
      EXPECT_LE(recovered->report.status.cost_after,
                plain->report.status.cost_after * (1.0 + 1e-9));
    }
  }
}

TEST(BranchRecovery, DoesNotChangeMotionsWithoutTheFault) {
  for (const char* name : {"unitree_g1", "engineai_pm01"}) {
    const RobotCase robot = robot_case(name);
    for (const char* file : {"wave.bvh", "squat.bvh"}) {
      SCOPED_TRACE(std::string(name) + " " + file);
      const Clip clip = cut(sample_clip(file), 20, 80);
      const auto plain = plainly_fitted(clip, robot);
      const auto recovered = fitted(clip, robot);
      EXPECT_THAT(recovered->report.notes, Not(Contains(HasSubstr("branch"))));
      for (int t = 0; t < clip.frame_count(); ++t) {
        EXPECT_TRUE(same(plain->clip, recovered->clip, t)) << t;
      }
    }
  }
}

TEST(BranchRecovery, CanBeStopped) {
  const Clip clip = up_sideways_down_in_front();
  const RobotCase robot = robot_case("unitree_h1");
  int asked = 0, limit = 1 << 30;
  FitRun run;
  run.keep_going = [&](double) { return asked++ < limit; };
  ASSERT_TRUE(plainly_fitted(clip, robot, {}, run).has_value());
  // Stop at the first request after all those of the plain fit.
  limit = asked;
  asked = 0;
  const auto stopped = fitted(clip, robot, {}, run);
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

class LimbSolverTest : public testing::Test {
 protected:
  LimbSolverTest() : robot_(robot_case("unitree_g1")) {
    BoneArray<int> target_of_bone(-1);
    for (const Bone bone : kAllBones) {
      if (robot_.config.body_of(bone) >= 0) target_of_bone[bone] = 0;
    }
    model_ = make_fit_model(*robot_.robot, robot_.config, robot_.robot->model_limits(),
                            target_of_bone, options_);
    limbs_ = find_limbs(model_);
  }

  // The targets of a configuration.
  FrameGoals goals_of(std::span<const double> qpos) {
    const TreeState pose(model_.tree, qpos);
    targets_.clear();
    for (const FitTask& task : model_.tasks) {
      const Pose& link = pose.world_from_link[static_cast<std::size_t>(task.link)];
      targets_.push_back({link * task.position, link.rotation});
    }
    upright_.assign(model_.feet.size(), 0.0);
    return {targets_, {}, upright_, {}, 1.0};
  }

  RobotCase robot_;
  FitOptions options_;
  FitModel model_;
  std::vector<FitLimb> limbs_;
  std::vector<TaskTarget> targets_;
  std::vector<double> upright_;
};

TEST_F(LimbSolverTest, FindsArmsAndLegs) {
  ASSERT_EQ(limbs_.size(), 4U);
  const std::array names = {"left arm", "left leg", "right arm", "right leg"};
  const std::array first = {"left_shoulder_pitch_joint", "left_hip_pitch_joint",
                            "right_shoulder_pitch_joint", "right_hip_pitch_joint"};
  const std::array<std::size_t, 4> joints = {7, 6, 7, 6};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(limbs_[i].name, names[i]);
    ASSERT_EQ(limbs_[i].links.size(), joints[i]);
    EXPECT_EQ(limbs_[i].links.front(), limbs_[i].link);
    const auto& link = model_.tree.links()[static_cast<std::size_t>(limbs_[i].link)];
    EXPECT_EQ(robot_.robot->joints()[static_cast<std::size_t>(link.joint)].name, first[i]);
    EXPECT_EQ(limbs_[i].tasks.size(), 3U);
  }
}

TEST_F(LimbSolverTest, ComparesRightJointsWithTheMirrorImagesOfLeftOnes) {
  using testing::ElementsAre;
  for (const std::size_t left : {0, 1}) {
    EXPECT_THAT(limbs_[left].reversed, testing::Each(false));
  }
  // Pitch, roll and yaw of the shoulder, elbow, roll, pitch and yaw of the wrist.
  EXPECT_THAT(limbs_[2].reversed, ElementsAre(false, true, true, false, true, false, true));
  // Pitch, roll and yaw of the hip, knee, pitch and roll of the ankle.
  EXPECT_THAT(limbs_[3].reversed, ElementsAre(false, true, true, false, false, true));
}

TEST_F(LimbSolverTest, ReachesTargetsInRangeAndMovesNoOtherLimb) {
  for (const FitLimb& limb : limbs_) {
    SCOPED_TRACE(limb.name);
    const std::vector<double> zero = robot_.robot->zero_configuration();
    std::vector<double> wanted = zero;
    for (std::size_t i = 0; i < limb.links.size(); ++i) {
      const auto dof = static_cast<std::size_t>(KinematicTree::dof_of(limb.links[i]));
      const double share = 0.4 + 0.05 * static_cast<double>(i % 3);
      joint_value(model_, limb.links[i], wanted) =
          model_.lower[dof] + share * (model_.upper[dof] - model_.lower[dof]);
    }
    const FrameGoals goals = goals_of(wanted);
    const LimbSolver solver(model_, limb);
    std::vector<double> qpos = zero;
    TreeState pose(model_.tree, qpos);
    const double before = solver.cost(pose, goals);
    const double left = solver.solve(goals, solver.limits(), pose, qpos);
    EXPECT_GT(before, 20.0);
    EXPECT_LT(left, 1e-2 * before);
    EXPECT_EQ(left, solver.cost(TreeState(model_.tree, qpos), goals));
    for (std::size_t link = 1; link < model_.tree.links().size(); ++link) {
      if (std::ranges::count(limb.links, static_cast<int>(link)) > 0) continue;
      const auto address = static_cast<std::size_t>(model_.tree.links()[link].qpos_address);
      EXPECT_EQ(qpos[address], zero[address]);
    }
  }
}

TEST_F(LimbSolverTest, StaysInItsRange) {
  const FitLimb& limb = limbs_.front();
  std::vector<double> wanted = robot_.robot->zero_configuration();
  joint_value(model_, limb.links[0], wanted) = -1.5;
  const FrameGoals goals = goals_of(wanted);
  const LimbSolver solver(model_, limb);
  std::vector<double> qpos = robot_.robot->zero_configuration();
  LimbRange range = solver.limits();
  range.lower[0] = joint_value(model_, limb.links[0], qpos) - 0.3;
  TreeState pose(model_.tree, qpos);
  solver.solve(goals, range, pose, qpos);
  EXPECT_EQ(joint_value(model_, limb.links[0], qpos), range.lower[0]);
}

TEST_F(LimbSolverTest, DoesNotStepTowardsNonFiniteTargets) {
  const std::vector<double> zero = robot_.robot->zero_configuration();
  for (const double bad : {std::nan(""), HUGE_VAL, 1e200}) {
    for (const FitLimb& limb : limbs_) {
      FrameGoals goals = goals_of(zero);
      targets_[limb.tasks.back()].position.x() = bad;
      goals.targets = targets_;
      const LimbSolver solver(model_, limb);
      std::vector<double> qpos = zero;
      TreeState pose(model_.tree, qpos);
      EXPECT_FALSE(std::isfinite(solver.solve(goals, solver.limits(), pose, qpos))) << limb.name;
      EXPECT_EQ(qpos, zero) << limb.name << ", " << bad;
    }
  }
}

// The cost of all terms decides, and that of the limb may rise.
TEST(BranchRecovery, NotesDoNotPromiseALowerError) {
  BranchRecovery recovery;
  recovery.limbs.push_back({"left arm", 10, 20, 4.0, 1.0});
  recovery.limbs.push_back({"right arm", 30, 40, 1.0, 1.3225});
  EXPECT_THAT(recovery.notes(),
              testing::ElementsAre("the left arm was stuck on a wrong branch in frames 10 to 19; "
                                   "on another branch its error is 50 % of the previous error",
                                   "the right arm is on another branch in frames 30 to 39, because "
                                   "the cost of all terms is lower there; its own error is 115 % "
                                   "of the previous error"));
}

}  // namespace
}  // namespace retarget
