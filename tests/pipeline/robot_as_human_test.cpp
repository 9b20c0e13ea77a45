// A robot as a human: the targets of a robot that follows its own human equal its own motion.

#include "solve/targets/robot_as_human.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/skeleton/robot_human.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/load_robot.h"
#include "retarget/robots.h"
#include "solve/targets/targets.h"
#include "support/value_of.h"

namespace retarget {
namespace {

struct SomeRobot {
  std::shared_ptr<const Robot> robot;
  ResolvedConfig config;
};

SomeRobot some_robot(const std::string& name) {
  const RobotFiles files = find_robot(name, {RETARGET_SOURCE_DIR "/robots"}).value();
  auto robot = load_robot_files(files.model.string(), files.profile.string()).value();
  ResolvedConfig config =
      load_config((files.model.parent_path() / "ik.json").string(), *robot).value();
  return {std::move(robot), std::move(config)};
}

// Random configurations in the middle of the joint ranges, with a random root.
RobotClip random_motion(const std::shared_ptr<const Robot>& robot, int frames) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  RobotClip motion(robot, {30, 1}, frames);
  for (int frame = 0; frame < frames; ++frame) {
    const auto qpos = motion.qpos(frame);
    for (int i = 0; i < 3; ++i) qpos[i] = unit(random);
    Eigen::Vector4d root(3.0, unit(random), unit(random), unit(random));
    root.normalize();
    for (int i = 0; i < 4; ++i) qpos[3 + i] = root[i];
    for (std::size_t j = 0; j < robot->joints().size(); ++j) {
      const double lower = std::max(robot->model_limits().lower[j], -1.5);
      const double upper = std::min(robot->model_limits().upper[j], 1.5);
      qpos[robot->joints()[j].qpos_address] =
          0.5 * (lower + upper) + 0.4 * (upper - lower) * unit(random);
    }
  }
  return motion;
}

double turn_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return 2.0 * std::atan2((a.conjugate() * b).vec().norm(), std::abs((a.conjugate() * b).w()));
}

class EveryRobot : public testing::TestWithParam<const char*> {};

TEST_P(EveryRobot, TargetsEqualItsOwnMotion) {
  const SomeRobot some = some_robot(GetParam());
  const RobotClip motion = random_motion(some.robot, 20);
  const auto as_human = value_of(RobotAsHuman::make(*some.robot, some.config));
  const Clip clip = clip_of_robot_human(as_human.human_of(motion), "random");
  const Calibration calibration = calibration_of_robot(clip, bone_map_of_robot(clip));
  HumanPoser poser(clip, calibration);
  const auto targets = value_of(make_targets(poser.info(), poses_of(poser), *some.robot,
                                             some.config, ScaleRule::kLimbs, TrunkRule::kLines));
  std::vector<Pose> world_from_target(static_cast<std::size_t>(targets.target_count()));
  std::vector<Pose> world_from_body(some.robot->bodies().size());
  HumanPose bones;
  const std::vector<Bone> followed = targets.bones();
  for (int frame = 0; frame < motion.frame_count(); ++frame) {
    poser.pose(frame, bones);
    targets.build(bones, world_from_target);
    forward_kinematics(*some.robot, motion.qpos(frame), world_from_body);
    const Eigen::Vector3d lift = world_from_target.front().translation -
                                 world_from_body[some.config.body_of(Bone::kHips)].translation;
    // Only the common height of ankles above soles.
    EXPECT_LT(lift.head<2>().norm(), 1e-4);
    for (std::size_t i = 0; i < followed.size(); ++i) {
      const ConfigTask& task = *some.config.find_task(followed[i]);
      const Pose& body = world_from_body[task.body];
      EXPECT_LT(turn_between(world_from_target[i].rotation, body.rotation), 1e-4)
          << bone_name(followed[i]) << " in frame " << frame;
      const auto part = limb_bone(followed[i]);
      if (part != LimbBone::kFootMod && part != LimbBone::kHand) continue;
      EXPECT_LT((world_from_target[i].translation - lift - body.translation).norm(), 1e-4)
          << bone_name(followed[i]) << " in frame " << frame;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, EveryRobot,
                         testing::Values("unitree_g1", "booster_t1_29dof", "unitree_h1",
                                         "fourier_n1", "stanford_toddy", "pal_talos",
                                         "engineai_pm01"));

TEST(RobotAsHuman, HasTheRobotsSolesAndLengths) {
  const SomeRobot g1 = some_robot("unitree_g1");
  const RobotClip still(g1.robot, {30, 1}, 30);
  const auto as_human = value_of(RobotAsHuman::make(*g1.robot, g1.config));
  const Clip clip = clip_of_robot_human(as_human.human_of(still), "still");
  EXPECT_EQ(clip.origin().robot, "unitree_g1");
  const HumanClip human = to_human(clip, calibration_of_robot(clip, bone_map_of_robot(clip)));
  const RobotLimbs limbs = robot_limbs(*g1.robot, g1.config).value();
  ASSERT_TRUE(human.built);
  EXPECT_NEAR(human.built->leg, limbs.lengths.leg, 1e-9);
  EXPECT_NEAR(human.built->upper_arm + human.built->forearm, limbs.lengths.arm, 1e-9);
  EXPECT_NEAR(human.built->trunk.norm(), limbs.lengths.trunk, 1e-9);
  EXPECT_NEAR(human.built->shoulders.norm(), limbs.shoulder_line.norm(), 1e-9);
  // Its soles are at one height, which is the floor.
  double lowest = 1.0;
  std::vector<Pose> world_from_body(g1.robot->bodies().size());
  forward_kinematics(*g1.robot, still.qpos(0), world_from_body);
  for (const Sole& sole : g1.robot->profile().soles) {
    for (const auto& point : sole.points) {
      lowest = std::min(lowest, (world_from_body[sole.body] * point).z());
    }
  }
  const ContactPlan contacts = find_contacts(human);
  EXPECT_TRUE(contacts.standing.found);
  EXPECT_NEAR(contacts.standing.of(kHeelEnd), lowest, 2e-3);
  EXPECT_NEAR(contacts.standing.of(kToeEnd), lowest, 2e-3);
  EXPECT_NEAR(contacts.standing.ankle - lowest, *limbs.ankle_height, 5e-3);
  for (int foot = 0; foot < 2; ++foot) {
    ASSERT_EQ(contacts.phases[foot].size(), 1U);
    EXPECT_EQ(contacts.phases[foot].front().end, 30);
  }
}

// A rolling foot: its contacts are those of its sole, not of its ankle.
TEST(RobotAsHuman, HeelsRiseAsSolesDo) {
  const SomeRobot g1 = some_robot("unitree_g1");
  RobotClip motion(g1.robot, {30, 1}, 60);
  const int pitch = *g1.robot->find_joint("left_ankle_pitch_joint");
  for (int frame = 30; frame < 60; ++frame) {
    motion.qpos(frame)[g1.robot->joints()[pitch].qpos_address] = -0.5;  // toes up
  }
  const auto as_human = value_of(RobotAsHuman::make(*g1.robot, g1.config));
  const Clip clip = clip_of_robot_human(as_human.human_of(motion), "toes up");
  const HumanClip human = to_human(clip, calibration_of_robot(clip, bone_map_of_robot(clip)));
  const SourceFeet feet(human, human.frame_count);
  std::vector<Pose> world_from_body(g1.robot->bodies().size());
  forward_kinematics(*g1.robot, motion.qpos(59), world_from_body);
  const Sole& left = g1.robot->profile().soles.front();
  ASSERT_EQ(left.side, "left");
  double highest = -1.0, lowest = 1.0;
  for (const auto& point : left.points) {
    const double z = (world_from_body[left.body] * point).z();
    highest = std::max(highest, z);
    lowest = std::min(lowest, z);
  }
  EXPECT_NEAR(feet.at(59, 0).end(kHeelEnd).z(), lowest, 5e-3);
  EXPECT_NEAR(feet.at(59, 0).end(kToeEnd).z(), highest, 2e-2);
  EXPECT_LT(feet.at(59, 0).steepness(), feet.at(0, 0).steepness() - 0.3);
}

}  // namespace
}  // namespace retarget
