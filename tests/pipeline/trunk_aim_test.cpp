// The rotation of a robot's trunk by a human's, compared with the robot's own kinematics.

#include "solve/targets/trunk_aim.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/load_robot.h"
#include "retarget/robots.h"
#include "retarget/so3.h"
#include "solve/targets/targets.h"
#include "support/angles.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

double trunk_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

// A human with straight lines and rotated pelvis and trunk.
HumanPose human(const Quaterniond& pelvis, const Quaterniond& trunk) {
  HumanPose bones;
  for (const Bone bone : kAllBones) {
    bones[bone].rotation = Quaterniond(canonical_t_pose(bone));
  }
  const auto at = [&](const char* bone) -> Pose& { return bones[bone_from_name(bone).value()]; };
  at("Hips").rotation = pelvis * at("Hips").rotation;
  at("LeftUpLeg").translation = pelvis * Vector3d(0, 0.09, 0);
  at("RightUpLeg").translation = pelvis * Vector3d(0, -0.09, 0);
  at("LeftArm").translation = trunk * Vector3d(-0.03, 0.17, 0.5);
  at("RightArm").translation = trunk * Vector3d(-0.03, -0.17, 0.5);
  return bones;
}

const Quaterniond kStill = Quaterniond::Identity();

struct AimedRobot {
  std::shared_ptr<const Robot> robot;
  RobotLimbs limbs;
  TrunkAim aim;
  int pelvis = 0, torso = 0;
  Quaterniond hips_to_pelvis;
};

AimedRobot aimed_robot(const std::string& name) {
  const RobotFiles files = find_robot(name, {RETARGET_SOURCE_DIR "/robots"}).value();
  auto robot = load_robot_files(files.model.string(), files.profile.string()).value();
  const ResolvedConfig config =
      load_config((files.model.parent_path() / "ik.json").string(), *robot).value();
  const RobotLimbs limbs = robot_limbs(*robot, config).value();
  auto trunk = robot_trunk(*robot, config, limbs, robot->model_limits()).value();
  const Quaterniond offset = config.find_task(Bone::kHips)->rotation_offset;
  const int pelvis = config.body_of(Bone::kHips);
  const ConfigTask* const spine = config.find_task(Bone::kSpine2);
  const int torso = spine == nullptr ? pelvis : spine->body;
  TrunkAim aim(std::move(trunk), trunk_lines(human(kStill, kStill)), offset);
  return {std::move(robot), limbs, std::move(aim), pelvis, torso, offset};
}

std::vector<std::string> robot_names() {
  return list_robots({RETARGET_SOURCE_DIR "/robots"});
}

class TrunkOf : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ShippedRobots, TrunkOf, ::testing::ValuesIn(robot_names()),
                         [](const auto& named) { return named.param; });

TEST_P(TrunkOf, IsUprightIfTheHumanIs) {
  const AimedRobot of = aimed_robot(GetParam());
  std::vector<Pose> world_from_body(of.robot->bodies().size());
  forward_kinematics(*of.robot, of.robot->zero_configuration(), world_from_body);
  const auto pose = [&](int body) { return world_from_body[static_cast<std::size_t>(body)]; };
  const auto aimed = of.aim.aim(human(kStill, kStill)).value();
  // Pelvis against torso, and the line between hips and shoulders, as in the zero configuration.
  const Quaterniond waist = pose(of.pelvis).rotation.conjugate() * pose(of.torso).rotation;
  EXPECT_LT(
      log_so3(waist.conjugate() * aimed.world_from_pelvis.conjugate() * aimed.world_from_torso)
          .norm(),
      1e-6);
  const Vector3d chord = of.limbs.shoulder_centre - of.limbs.hip_centre;
  EXPECT_NEAR(aimed.chord.z(), chord.z(), 1e-6);
  EXPECT_NEAR(aimed.chord.norm(), chord.norm(), 1e-6);
  const Quaterniond hips(canonical_t_pose(Bone::kHips));
  EXPECT_LT(log_so3((hips * of.hips_to_pelvis).conjugate() * aimed.world_from_pelvis).norm(), 1e-6);
}

TEST_P(TrunkOf, LeansAsTheHumanForAnyWaist) {
  const AimedRobot of = aimed_robot(GetParam());
  const auto upright = of.aim.aim(human(kStill, kStill));
  for (const Vector3d& bend : {Vector3d(0, 0.5, 0), Vector3d(0.3, 0, 0), Vector3d(0.1, 0.8, 0.1)}) {
    const auto aimed = of.aim.aim(human(kStill, exp_so3(bend))).value();
    // A rigid trunk lets the pelvis, which did not move, rotate a little.
    EXPECT_LT(trunk_between(aimed.chord, exp_so3(bend) * upright->chord), 4.0) << bend.transpose();
  }
}

// The G1's waist by its own kinematics: chord and shoulder line for a pelvis rotation and joint
// positions.
struct WaistPose {
  Quaterniond pelvis;
  Vector3d yaw_roll_pitch;
};
TrunkLines lines_of(const AimedRobot& of, const WaistPose& pose) {
  std::vector<double> qpos = of.robot->zero_configuration();
  qpos[3] = pose.pelvis.w();
  qpos[4] = pose.pelvis.x();
  qpos[5] = pose.pelvis.y();
  qpos[6] = pose.pelvis.z();
  const std::array names = {"waist_yaw_joint", "waist_roll_joint", "waist_pitch_joint"};
  for (std::size_t i = 0; i < 3; ++i) {
    const RobotJoint& joint = of.robot->joints()[of.robot->find_joint(names[i]).value()];
    qpos[static_cast<std::size_t>(joint.qpos_address)] =
        pose.yaw_roll_pitch[static_cast<Eigen::Index>(i)];
  }
  std::vector<Pose> zero(of.robot->bodies().size()), now = zero;
  forward_kinematics(*of.robot, of.robot->zero_configuration(), zero);
  forward_kinematics(*of.robot, qpos, now);
  const auto moved = [&](int body, const Vector3d& point) {
    const auto index = static_cast<std::size_t>(body);
    return Vector3d(now[index] * (zero[index].inverse() * point));
  };
  const Vector3d half = 0.5 * of.limbs.shoulder_line;
  const Vector3d left = moved(of.torso, of.limbs.shoulder_centre + half);
  const Vector3d right = moved(of.torso, of.limbs.shoulder_centre - half);
  return {0.5 * (left + right) - moved(of.pelvis, of.limbs.hip_centre), left - right};
}

WaistPose waist_pose(const TrunkAim::Aimed& aimed) {
  // The torso rotates about z, then x, then y relative to the pelvis.
  const Eigen::Matrix3d r = (aimed.world_from_pelvis.conjugate() * aimed.world_from_torso)
                                .normalized()
                                .toRotationMatrix();
  return {aimed.world_from_pelvis,
          {std::atan2(-r(0, 1), r(1, 1)), std::asin(r(2, 1)), std::atan2(-r(2, 0), r(2, 2))}};
}

TEST(TrunkAim, ShouldersMatchForwardKinematics) {
  const AimedRobot of = aimed_robot("unitree_g1");
  const auto aimed = of.aim.aim(human(exp_so3({0.1, 0.2, 0.5}), exp_so3({-0.1, 0.6, 0.9}))).value();
  EXPECT_LT((lines_of(of, waist_pose(aimed)).chord - aimed.chord).norm(), 1e-9);
}

TEST(TrunkAim, IsOptimalForTheWaist) {
  const AimedRobot of = aimed_robot("unitree_g1");
  const TrunkLines zero = {of.limbs.shoulder_centre - of.limbs.hip_centre, of.limbs.shoulder_line};
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto noise = [&](double size) {
    return Vector3d(size * Vector3d(normal(random), normal(random), normal(random)));
  };
  const double pitch_range = 0.52 * 0.9;
  int at_limit = 0;
  for (int i = 0; i < 50; ++i) {
    const Quaterniond pelvis = exp_so3(noise(0.3)), trunk = exp_so3(noise(0.6));
    const auto aimed = of.aim.aim(human(pelvis, trunk)).value();
    const auto cost = [&](const WaistPose& pose) {
      const TrunkLines lines = lines_of(of, pose);
      return (lines.chord.normalized() - trunk * zero.chord.normalized()).squaredNorm() +
             0.25 * (lines.across.normalized() - trunk * zero.across.normalized()).squaredNorm() +
             0.04 * log_so3(pose.pelvis * pelvis.conjugate()).squaredNorm();
    };
    const WaistPose best = waist_pose(aimed);
    EXPECT_LE(std::abs(best.yaw_roll_pitch.y()), pitch_range + 1e-9);
    EXPECT_LE(std::abs(best.yaw_roll_pitch.z()), pitch_range + 1e-9);
    at_limit += std::abs(best.yaw_roll_pitch.z()) > pitch_range - 1e-9 ? 1 : 0;
    const double min = cost(best);
    for (int other = 0; other < 60; ++other) {
      WaistPose near{exp_so3(noise(0.01)) * best.pelvis, best.yaw_roll_pitch + noise(0.01)};
      for (const int bounded : {1, 2}) {
        near.yaw_roll_pitch[bounded] =
            std::clamp(near.yaw_roll_pitch[bounded], -pitch_range, pitch_range);
      }
      EXPECT_GE(cost(near), min - 1e-9) << i;
    }
  }
  // Some of them exceed the range of the waist.
  EXPECT_GT(at_limit, 3);
}

TEST(RobotTrunk, RespectsTheLimitSet) {
  const AimedRobot of = aimed_robot("unitree_g1");
  const ResolvedConfig config =
      load_config(RETARGET_SOURCE_DIR "/robots/unitree_g1/ik.json", *of.robot).value();
  LimitSet limits = of.robot->model_limits();
  const std::size_t yaw = of.robot->find_joint("waist_yaw_joint").value();
  const std::size_t roll = of.robot->find_joint("waist_roll_joint").value();
  const std::size_t pitch = of.robot->find_joint("waist_pitch_joint").value();
  // Unlimited, held, and narrow.
  limits.lower[yaw] = -std::numeric_limits<double>::infinity();
  limits.upper[yaw] = std::numeric_limits<double>::infinity();
  limits.lower[roll] = limits.upper[roll] = 0.0;
  limits.lower[pitch] = -0.1;
  limits.upper[pitch] = 0.3;
  auto trunk = robot_trunk(*of.robot, config, of.limbs, limits).value();
  ASSERT_EQ(trunk.waist.size(), 2u);
  EXPECT_EQ(trunk.waist[0].upper, limits.upper[yaw]);
  EXPECT_NEAR(trunk.waist[1].lower, -0.08, 1e-12);
  EXPECT_NEAR(trunk.waist[1].upper, 0.28, 1e-12);
  // The pelvis takes the part of the rotation that exceeds the waist's range.
  const TrunkAim aim(std::move(trunk), trunk_lines(human(kStill, kStill)), of.hips_to_pelvis);
  const auto upright = aim.aim(human(kStill, kStill));
  const Quaterniond bend = exp_so3({0.0, 0.8, 0.5});
  const auto aimed = aim.aim(human(kStill, bend));
  ASSERT_TRUE(aimed && upright);
  EXPECT_LT(trunk_between(aimed->chord, bend * upright->chord), 4.0);
  EXPECT_NEAR(waist_pose(*aimed).yaw_roll_pitch.z(), 0.28, 1e-9);
}

TEST(TrunkAim, PlacesLegsBelowTheRobotsHips) {
  const AimedRobot of = aimed_robot("unitree_g1");
  const ResolvedConfig config =
      load_config(RETARGET_SOURCE_DIR "/robots/unitree_g1/ik.json", *of.robot).value();
  // Hips 18 cm apart, legs straight down.
  HumanPose bones = human(kStill, kStill);
  for (const std::string side : {"Left", "Right"}) {
    const double y = side == "Left" ? 0.09 : -0.09;
    const auto put = [&](const char* part, double z) {
      bones[bone_from_name(side + part).value()].translation = {0.0, y, z};
    };
    put("Leg", -0.45);
    put("Foot", -0.9);
    put("FootMod", -0.9);
  }
  const LimbLengths lengths{0.9, 0.5, 0.5};
  const TargetBuilder targets(config, of.limbs, lengths, of.aim);
  std::vector<Pose> world_from_target(static_cast<std::size_t>(targets.target_count()));
  targets.build(bones, world_from_target);
  for (const std::string side : {"Left", "Right"}) {
    const Bone bone = bone_from_name(side + "FootMod").value();
    const Pose& foot = world_from_target[static_cast<std::size_t>(targets.target_of(bone))];
    const Vector3d ankle = foot * of.limbs.body_from_joint[bone];
    EXPECT_FALSE(targets.is_of_trunk(targets.target_of(bone)));
    const double sign = side == "Left" ? 1.0 : -1.0;
    EXPECT_NEAR(ankle.y(), sign * 0.5 * of.limbs.hip_line.norm(), 1e-6);
    EXPECT_NEAR(ankle.x(), 0.0, 1e-6);
  }
  // 4 cm farther out than the scaled human's.
  EXPECT_GT(of.limbs.hip_line.norm(), 0.18 * of.limbs.lengths.leg / 0.9 + 0.07);
}

TEST(TrunkAim, SingleRotationsAreThoseOfAllTargets) {
  const AimedRobot of = aimed_robot("unitree_g1");
  const ResolvedConfig config =
      load_config(RETARGET_SOURCE_DIR "/robots/unitree_g1/ik.json", *of.robot).value();
  HumanPose bones = human(exp_so3(Vector3d(0.1, 0.4, 0.2)), exp_so3(Vector3d(0.2, 0.6, -0.1)));
  bones[Bone::kLeftForeArm].translation += Vector3d(0.1, 0.3, 0.2);
  const TargetBuilder targets(config, of.limbs, LimbLengths{0.9, 0.5, 0.5}, of.aim);
  std::vector<Pose> world_from_target(static_cast<std::size_t>(targets.target_count()));
  targets.build(bones, world_from_target);
  const auto trunk = targets.aim_trunk(bones);
  ASSERT_TRUE(trunk);
  int of_trunk = 0;
  for (int target = 0; target < targets.target_count(); ++target) {
    const Eigen::Quaterniond rotation =
        targets.rotation(target, bones, targets.is_of_trunk(target) ? trunk : std::nullopt);
    EXPECT_EQ(rotation.coeffs(),
              world_from_target[static_cast<std::size_t>(target)].rotation.coeffs());
    if (targets.is_of_trunk(target)) ++of_trunk;
  }
  EXPECT_EQ(of_trunk, 2);
}

TEST(TrunkAim, RequiresATrunk) {
  const AimedRobot of = aimed_robot("unitree_g1");
  EXPECT_FALSE(of.aim.aim(HumanPose()));
}

// A non-finite step is rejected and visible in the targets, which the solvers reject.
TEST(TrunkAim, ReturnsNonFiniteRotationsForANonFiniteHuman) {
  const AimedRobot of = aimed_robot("unitree_g1");
  HumanPose bones = human(kStill, kStill);
  bones[Bone::kHips].rotation.coeffs().fill(std::nan(""));
  const auto aimed = of.aim.aim(bones).value();
  for (const Quaterniond& rotation : {aimed.world_from_pelvis, aimed.world_from_torso}) {
    EXPECT_TRUE(rotation.coeffs().array().isNaN().all());
  }
  EXPECT_FALSE(aimed.chord.allFinite());
}

}  // namespace
}  // namespace retarget
