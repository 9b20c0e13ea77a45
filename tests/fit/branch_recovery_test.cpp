// Limbs on the wrong branch: motions in which the fit alone leaves them there.

#include "solve/fit/branch_recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "retarget/clip_range.h"
#include "solve/fit/fit.h"
#include "solve/fit/limb_solver.h"
#include "support/lafan1_map.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const std::filesystem::path kRoot = RETARGET_SOURCE_DIR;

Clip sample_clip(const std::string& name) {
  auto clip = load_bvh((kRoot / "data" / name).string());
  EXPECT_TRUE(clip.has_value());
  return std::move(clip->clip);
}

// Directions of the upper arms, degrees: elevation from the horizontal, outwards from the front;
// and the elbow flexion, upwards.
struct ArmPose {
  double up, outwards, bend;
};

// Sets the arms of a standing person.
class ArmPoser {
 public:
  explicit ArmPoser(const Clip& clip) : skeleton_(clip.skeleton()) {
    left_ = clip.rotations(0)[0] * Vector3d::UnitZ();
    left_.y() = 0.0;
    left_.normalize();
    front_ = left_.cross(Vector3d::UnitY());
  }

  void pose(std::span<Quaterniond> rotations, const ArmPose& arms) const {
    for (const std::string side : {"Left", "Right"}) {
      const Vector3d outwards = side == "Left" ? left_ : Vector3d(-left_);
      const double up = radians(arms.up), out = radians(arms.outwards), bend = radians(arms.bend);
      const Vector3d level = std::cos(out) * front_ + std::sin(out) * outwards;
      const Vector3d upper = std::sin(up) * Vector3d::UnitY() + std::cos(up) * level;
      const Vector3d bent = std::cos(up) * Vector3d::UnitY() - std::sin(up) * level;
      const Vector3d lower = std::cos(bend) * upper + std::sin(bend) * bent;
      const Vector3d hinge = -upper.cross(lower).normalized();
      turn(rotations, side + "Arm", along(upper, hinge));
      turn(rotations, side + "ForeArm", along(lower, hinge));
      rotations[joint(side + "Hand")] = Quaterniond::Identity();
    }
  }

 private:
  static double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
  static Quaterniond along(const Vector3d& x, const Vector3d& z) {
    Matrix3d axes;
    axes << x, z.cross(x), z;
    return Quaterniond(axes);
  }
  [[nodiscard]] std::size_t joint(const std::string& name) const {
    return static_cast<std::size_t>(skeleton_.find(name).value());
  }
  void turn(std::span<Quaterniond> rotations, const std::string& name,
            const Quaterniond& world_from_bone) const {
    const std::size_t own = joint(name);
    Quaterniond world_from_parent = Quaterniond::Identity();
    for (int j = skeleton_.joint(static_cast<int>(own)).parent; j >= 0;
         j = skeleton_.joint(j).parent) {
      world_from_parent = rotations[static_cast<std::size_t>(j)] * world_from_parent;
    }
    rotations[own] = (world_from_parent.conjugate() * world_from_bone).normalized();
  }

  const Skeleton& skeleton_;
  Vector3d left_, front_;
};

// A standing person moves both arms from pose to pose, one per second.
Clip arm_movement(std::span<const ArmPose> poses) {
  const Clip standing = cut(sample_clip("wave.bvh"), 0, 1);
  const ArmPoser poser(standing);
  constexpr int kFrames = 30;
  Clip clip(standing.shared_skeleton(), standing.rate(),
            kFrames * static_cast<int>(poses.size() - 1) + 1);
  for (int t = 0; t < clip.frame_count(); ++t) {
    std::ranges::copy(standing.rotations(0), clip.rotations(t).begin());
    std::ranges::copy(standing.translations(0), clip.translations(t).begin());
    const auto from = std::min(static_cast<std::size_t>(t / kFrames), poses.size() - 2);
    const double share = static_cast<double>(t) / kFrames - static_cast<double>(from);
    const double s = share * share * (3.0 - 2.0 * share);
    const ArmPose &a = poses[from], &b = poses[from + 1];
    poser.pose(clip.rotations(t),
               {a.up + s * (b.up - a.up), a.outwards + s * (b.outwards - a.outwards),
                a.bend + s * (b.bend - a.bend)});
  }
  return clip;
}

// Raised sideways over the head and lowered in front: the shoulder has two ways down.
Clip up_sideways_down_in_front() {
  return arm_movement(std::array<ArmPose, 6>{
      {{-85, 90, 5}, {0, 90, 5}, {88, 90, 5}, {60, 0, 60}, {0, 0, 90}, {-85, 60, 10}}});
}

struct RobotCase {
  std::shared_ptr<const Robot> robot;
  ResolvedConfig config;
};

RobotCase robot_case(const std::string& name) {
  const auto folder = kRoot / "robots" / name;
  const auto robot =
      load_robot_files((folder / "model.xml").string(), (folder / "robot.json").string());
  EXPECT_TRUE(robot.has_value());
  const auto config = load_config((folder / "ik.json").string(), **robot);
  EXPECT_TRUE(config.has_value());
  return {*robot, *config};
}

Result<FitResult> fitted(const Clip& clip, const RobotCase& robot, const FitOptions& options = {},
                         const FitRun& given = {}) {
  FitRun run = given;
  run.retarget.scale = ScaleRule::kLimbs;
  return fit(clip, lafan1_calibration(clip.skeleton()), robot.robot, robot.config,
             robot.robot->model_limits(), options, run);
}

// The fit without recovery.
Result<FitResult> plainly_fitted(const Clip& clip, const RobotCase& robot,
                                 const FitOptions& options = {}, FitRun run = {}) {
  run.recover_limbs = false;
  return fitted(clip, robot, options, run);
}

bool same(const RobotClip& a, const RobotClip& b, int frame) {
  return std::ranges::equal(a.qpos(frame), b.qpos(frame));
}

TEST(BranchRecovery, MovesArmsToTheBranchThatTracks) {
  const Clip clip = up_sideways_down_in_front();
  for (const char* name : {"unitree_h1", "engineai_pm01"}) {
    SCOPED_TRACE(name);
    const RobotCase robot = robot_case(name);
    const auto plain = plainly_fitted(clip, robot);
    const auto recovered = fitted(clip, robot);
    ASSERT_TRUE(plain.has_value());
    ASSERT_TRUE(recovered.has_value());
    EXPECT_THAT(plain->report.notes, Not(Contains(HasSubstr("branch"))));
    EXPECT_THAT(recovered->report.notes,
                Contains(HasSubstr("the left arm was stuck on a wrong branch in frames ")));
    EXPECT_THAT(recovered->report.notes,
                Contains(HasSubstr("the right arm was stuck on a wrong branch in frames ")));
    // Without recovery, the fit is wrong for about two of five seconds.
    EXPECT_LT(recovered->report.status.cost_after, 0.5 * plain->report.status.cost_after);
    const auto rotation = [](const FitReport& report) {
      return std::ranges::find(report.terms, "rotation", &FitTermReport::name)->after;
    };
    EXPECT_LT(rotation(recovered->report), 0.5 * rotation(plain->report));
    // The arms are free until they are up.
    for (int t = 0; t < 5; ++t) EXPECT_TRUE(same(plain->clip, recovered->clip, t)) << t;
  }
}

TEST(BranchRecovery, SolvesLongIntervalsInParts) {
  const Clip clip = up_sideways_down_in_front();
  const RobotCase robot = robot_case("unitree_h1");
  FitOptions options;
  options.window = 2.5;
  const auto recovered = fitted(clip, robot, options);
  const auto plain = plainly_fitted(clip, robot, options);
  ASSERT_TRUE(plain.has_value());
  ASSERT_TRUE(recovered.has_value());
  EXPECT_LT(recovered->report.status.cost_after, 0.6 * plain->report.status.cost_after);
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

TEST(BranchRecovery, NeverIncreasesTheCost) {
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
      const auto plain = plainly_fitted(clip, robot);
      const auto recovered = fitted(clip, robot);
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
  // The first stop request after all those of the plain fit.
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

TEST_F(LimbSolverTest, TakesNoStepTowardsTargetsThatAreNotFinite) {
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

}  // namespace
}  // namespace retarget
