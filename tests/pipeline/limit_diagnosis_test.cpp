// The diagnosis of joints at a limit, against finite differences and closed forms.

#include "solve/targets/limit_diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/math/se3.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// An upper arm whose hinge stops long before the arm hangs down, and a slide at its end.
constexpr const char* kStiffArm = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 1">
      <freejoint/>
      <geom size="0.1"/>
      <body name="upper" pos="0 0.2 0.1">
        <joint name="shoulder" axis="1 0 0" range="-0.25 0.25"/>
        <geom size="0.05"/>
        <body name="lower" pos="0 0.3 0">
          <joint name="slide" type="slide" axis="0 1 0" range="-0.1 0.1"/>
          <joint name="twist" axis="0 1 0"/>
          <geom size="0.05"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

IkMatch task_row(const std::string& body, const std::string& bone, double position,
                 double rotation) {
  IkMatch row;
  row.body = body;
  row.bone = bone;
  row.position_weight = position;
  row.rotation_weight = rotation;
  return row;
}

RetargetingConfig tables_of(std::vector<IkMatch> rows) {
  RetargetingConfig config;
  config.robot_root = "base";
  config.human_root = "Hips";
  config.human_height_assumption = 1.0;
  config.scales = {{"Hips", 1.0}, {"LeftArm", 1.0}, {"LeftForeArm", 1.0}, {"RightArm", 1.0}};
  // The first pass must be ignored.
  config.match_tables[0].rows = {task_row("base", "Hips", 100, 100)};
  config.match_tables[1].rows = std::move(rows);
  return config;
}

// Each bone coincides with a body of the robot, up to a fixed translation and rotation.
struct Scene {
  std::shared_ptr<const Robot> robot;
  RobotClip clip;
  RetargetingConfig config;
  HumanPose world_from_bone;

  [[nodiscard]] std::vector<JointAtLimit> diagnose(const LimitSet& limits,
                                                   double min_share = 0.05) const {
    const ResolvedConfig resolved = resolve_config(config, *robot).value();
    const TargetBuilder targets(resolved, 1.0);
    return joints_at_limits(
        clip, resolved, targets, [&](int, HumanPose& bones) { bones = world_from_bone; }, limits,
        min_share);
  }
};

void set_joint(Scene& scene, int frame, const char* name, double q) {
  const RobotJoint& joint = scene.robot->joints()[*scene.robot->find_joint(name)];
  scene.clip.qpos(frame)[joint.qpos_address] = q;
}

Scene stiff_arm(std::vector<IkMatch> rows, int frames) {
  Scene scene;
  scene.robot = robot_from_text(kStiffArm);
  scene.clip = RobotClip(scene.robot, {30, 1}, frames);
  scene.config = tables_of(std::move(rows));
  return scene;
}

TEST(JointsAtLimits, ReportsThePushingTaskAndItsShortfall) {
  Scene scene = stiff_arm({task_row("base", "Hips", 100, 100), task_row("upper", "LeftArm", 0, 10),
                           task_row("lower", "LeftForeArm", 1, 0)},
                          10);
  // A hanging arm: rotated by -1 rad about x; the forearm is at the robot's position.
  for (const int frame : {2, 3, 4, 7}) set_joint(scene, frame, "shoulder", -0.25);
  std::vector<Pose> poses(scene.robot->bodies().size());
  forward_kinematics(*scene.robot, scene.clip.qpos(2), poses);
  scene.world_from_bone[Bone::kHips] = poses[1];
  scene.world_from_bone[Bone::kLeftArm] = {
      Eigen::Quaterniond(Eigen::AngleAxisd(-1.0, Eigen::Vector3d::UnitX())), {0, 0, 0}};
  scene.world_from_bone[Bone::kLeftForeArm] = poses[3];
  const auto found = scene.diagnose(scene.robot->model_limits());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(scene.robot->joints()[found[0].joint].name, "shoulder");
  EXPECT_FALSE(found[0].at_upper);
  EXPECT_EQ(found[0].frames, 4);
  EXPECT_EQ(found[0].share, 0.4);
  EXPECT_EQ(found[0].wider_set, "");
  ASSERT_TRUE(found[0].push.has_value());
  EXPECT_EQ(found[0].push->bone, Bone::kLeftArm);
  EXPECT_EQ(scene.robot->bodies()[found[0].push->body].name, "upper");
  EXPECT_TRUE(found[0].push->rotation);
  EXPECT_NEAR(found[0].push->shortfall, 0.75, 1e-12);
  // 1/2 (10 * angle)^2 falls by 100 * angle per rad.
  EXPECT_NEAR(found[0].push->strength, 75.0, 1e-9);
}

TEST(JointsAtLimits, PositionShortfallIsInMetres) {
  Scene scene = stiff_arm({task_row("lower", "LeftForeArm", 10, 0)}, 2);
  for (const int frame : {0, 1}) set_joint(scene, frame, "slide", 0.1);
  std::vector<Pose> poses(scene.robot->bodies().size());
  forward_kinematics(*scene.robot, scene.clip.qpos(0), poses);
  poses[3].translation += Eigen::Vector3d(0, 0.3, 0.4);
  scene.world_from_bone[Bone::kLeftForeArm] = poses[3];
  const auto found = scene.diagnose(scene.robot->model_limits());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_TRUE(found[0].at_upper);
  ASSERT_TRUE(found[0].push.has_value());
  EXPECT_FALSE(found[0].push->rotation);
  EXPECT_NEAR(found[0].push->shortfall, 0.5, 1e-12);
  EXPECT_NEAR(found[0].push->strength, 100 * 0.3, 1e-9);
}

TEST(JointsAtLimits, RestingJointHasNoPushingTask) {
  // The target is inside the limit, and no task pushes the slide, which is ignored.
  Scene scene = stiff_arm({task_row("upper", "LeftArm", 0, 10)}, 1);
  set_joint(scene, 0, "shoulder", 0.25);
  set_joint(scene, 0, "slide", -0.2);  // Beyond the limit.
  const auto found = scene.diagnose(scene.robot->model_limits());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].joint, 0);
  EXPECT_FALSE(found[0].push.has_value());
}

TEST(JointsAtLimits, UsesAnEarlierPassIfTheLastDoesNotMoveTheJoint) {
  Scene scene = stiff_arm({task_row("base", "Hips", 10, 10)}, 1);
  scene.config.match_tables[0].rows = {task_row("upper", "LeftArm", 0, 10)};
  set_joint(scene, 0, "shoulder", 0.25);
  scene.world_from_bone[Bone::kLeftArm].rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
  const auto found = scene.diagnose(scene.robot->model_limits());
  ASSERT_THAT(found, SizeIs(1));
  ASSERT_TRUE(found[0].push.has_value());
  EXPECT_EQ(found[0].push->bone, Bone::kLeftArm);
}

TEST(JointsAtLimits, SortsByFramesAndDropsRareOnes) {
  Scene scene = stiff_arm({task_row("lower", "LeftArm", 10, 10)}, 10);
  for (int frame = 0; frame < 10; ++frame) {
    if (frame < 3) set_joint(scene, frame, "shoulder", 0.25);
    if (frame == 5) set_joint(scene, frame, "shoulder", -0.25);
    if (frame > 4) set_joint(scene, frame, "slide", 0.1);
  }
  const auto shares = [&](double min_share) {
    std::vector<double> all;
    for (const auto& found : scene.diagnose(scene.robot->model_limits(), min_share)) {
      all.push_back(found.share);
    }
    return all;
  };
  EXPECT_THAT(shares(0.05), ElementsAre(0.5, 0.3, 0.1));
  EXPECT_THAT(shares(0.3), ElementsAre(0.5, 0.3));
  EXPECT_THAT(shares(0.6), IsEmpty());
  scene.clip = RobotClip(scene.robot, {30, 1}, 0);
  EXPECT_THAT(shares(0.0), IsEmpty());
}

TEST(JointsAtLimits, ReportsTheWiderLimitSet) {
  const auto g1 = load_g1();
  Scene scene;
  scene.robot = g1;
  scene.clip = RobotClip(g1, {30, 1}, 1);
  scene.config = tables_of({task_row("left_elbow_link", "LeftForeArm", 0, 1),
                            task_row("right_elbow_link", "RightArm", 0, 1)});
  scene.config.robot_root = "pelvis";
  scene.config.match_tables[0].rows.clear();  // there is no such body
  const LimitSet gmr = load_limits(*g1, "gmr").value();
  set_joint(scene, 0, "left_elbow_joint", 1.7);
  set_joint(scene, 0, "right_elbow_joint", -1.0472);
  const auto found = scene.diagnose(gmr);
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].wider_set, "official");
  EXPECT_NEAR(found[0].wider_by, 2.0944 - 1.7, 1e-12);
  EXPECT_EQ(found[1].wider_set, "");
}

TEST(JointsAtLimits, IgnoresHeldJoints) {
  Scene scene = stiff_arm({}, 1);
  LimitSet limits = scene.robot->model_limits();
  limits.lower[0] = limits.upper[0] = 0.0;
  EXPECT_THAT(scene.diagnose(limits), IsEmpty());
}

// One task on the two arms, in a random configuration and with a random target.
struct RandomTask {
  Scene scene;
  IkMatch row;
  Pose target;
};

RandomTask random_task(int trial, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  RandomTask task;
  Scene& scene = task.scene;
  scene.robot = robot_from_text(kTwoArms);
  scene.clip = RobotClip(scene.robot, {30, 1}, 1);
  const bool rotates = trial % 2 == 0;
  task.row = task_row(trial % 3 == 0 ? "right_upper" : "left_lower", "LeftArm", rotates ? 0.0 : 3.0,
                      rotates ? 2.0 : 0.0);
  scene.config = tables_of({task.row});
  scene.config.match_tables[0].used = false;
  const auto qpos = scene.clip.qpos(0);
  for (double& q : qpos) q = 0.5 * uniform(random);
  const double norm = std::hypot(std::hypot(qpos[3], qpos[4]), std::hypot(qpos[5], qpos[6]));
  for (int i = 3; i < 7; ++i) qpos[i] /= norm;
  for (int i = 0; i < 3; ++i) task.target.translation[i] = 0.5 * uniform(random);
  task.target.rotation =
      Eigen::Quaterniond(1.0, uniform(random), uniform(random), uniform(random)).normalized();
  scene.world_from_bone[Bone::kLeftArm] = task.target;
  return task;
}

// Half the squared weighted error of the task.
double objective(const RandomTask& task, std::span<const double> qpos) {
  std::vector<Pose> poses(task.scene.robot->bodies().size());
  forward_kinematics(*task.scene.robot, qpos, poses);
  const Pose& body = poses[*task.scene.robot->find_body(task.row.body)];
  const Vector6d error = log_se3(body.inverse() * task.target);
  return 0.5 * std::pow(task.row.position_weight, 2) * error.head<3>().squaredNorm() +
         0.5 * std::pow(task.row.rotation_weight, 2) * error.tail<3>().squaredNorm();
}

// Its decrease per rad or m of a joint's outward movement, by finite differences.
double numeric_fall(const RandomTask& task, int address, bool upper) {
  constexpr double kStep = 1e-5;
  const auto qpos = task.scene.clip.qpos(0);
  std::vector<double> moved(qpos.begin(), qpos.end());
  moved[address] = qpos[address] + kStep;
  const double above = objective(task, moved);
  moved[address] = qpos[address] - kStep;
  const double below = objective(task, moved);
  return (below - above) / (2 * kStep) * (upper ? 1.0 : -1.0);
}

// Treats each joint as if it were at its upper limit, then at its lower one.
TEST(JointsAtLimits, PushIsTheDerivativeOfTheObjective) {
  std::mt19937 random(5);
  int pushed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const RandomTask task = random_task(trial, random);
    const auto& joints = task.scene.robot->joints();
    for (std::size_t j = 0; j < joints.size(); ++j) {
      for (const bool upper : {false, true}) {
        LimitSet limits = task.scene.robot->model_limits();
        std::ranges::fill(limits.lower, -9.0);
        std::ranges::fill(limits.upper, 9.0);
        const RobotClip& clip = task.scene.clip;
        (upper ? limits.upper : limits.lower)[j] = clip.qpos(0)[joints[j].qpos_address];
        const auto found = task.scene.diagnose(limits);
        const double fall = numeric_fall(task, joints[j].qpos_address, upper);
        if (found.empty() || !found[0].push) {
          EXPECT_LT(fall, 1e-7);
          continue;
        }
        EXPECT_EQ(found[0].joint, static_cast<int>(j));
        EXPECT_EQ(found[0].push->rotation, task.row.rotation_weight > 0.0);
        EXPECT_NEAR(found[0].push->strength, fall, 1e-7);
        ++pushed;
      }
    }
  }
  EXPECT_GT(pushed, 60);
}

}  // namespace
}  // namespace retarget
