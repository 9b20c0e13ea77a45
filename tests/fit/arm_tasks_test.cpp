// Hands follow only rotations that their wrist joints can make.

#include "solve/fit/arm_tasks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "solve/fit/fit.h"
#include "solve/targets/targets.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// A robot with its published configuration and the fit's model of it.
struct ModelledRobot {
  std::shared_ptr<const Robot> robot;
  ResolvedConfig config;
  LimitSet limits;
  FitModel model;

  [[nodiscard]] std::size_t body(const std::string& name) const {
    return static_cast<std::size_t>(robot->find_body(name).value());
  }
  [[nodiscard]] std::size_t joint(const std::string& name) const {
    return static_cast<std::size_t>(robot->find_joint(name).value());
  }
  [[nodiscard]] const FitTask& task(Bone bone) const {
    return *std::ranges::find(model.tasks, bone, &FitTask::bone);
  }
};

/// @param held  joints and the position at which each is held
ModelledRobot modelled(const std::string& name,
                       const std::vector<std::pair<std::string, double>>& held = {}) {
  ModelledRobot all;
  all.robot = load_robot_in(std::string(RETARGET_SOURCE_DIR "/robots/") + name);
  const std::string config = RETARGET_SOURCE_DIR "/configs/lafan1_to_" + name + ".json";
  all.config = value_of(load_config(config, *all.robot));
  all.limits = all.robot->model_limits();
  for (const auto& [joint, position] : held) {
    all.limits.lower[all.joint(joint)] = all.limits.upper[all.joint(joint)] = position;
  }
  const TargetBuilder targets(all.config, 1.75);
  BoneArray<int> target_of_bone;
  for (const Bone bone : kAllBones) target_of_bone[bone] = targets.target_of(bone);
  all.model = make_fit_model(*all.robot, all.config, all.limits, target_of_bone, FitOptions{});
  return all;
}

// The axis about which a joint rotates a task's link, in the link's frame, by finite differences.
Vector3d axis_of(const ModelledRobot& all, const std::string& joint, const FitTask& task) {
  std::vector<double> qpos = all.robot->zero_configuration();
  for (std::size_t j = 0; j < all.robot->joints().size(); ++j) {
    const auto address = static_cast<std::size_t>(all.robot->joints()[j].qpos_address);
    if (all.limits.lower[j] == all.limits.upper[j]) qpos[address] = all.limits.lower[j];
  }
  const auto world_from_link = [&](double step) {
    std::vector<double> moved = qpos;
    moved[static_cast<std::size_t>(all.robot->joints()[all.joint(joint)].qpos_address)] += step;
    std::vector<Pose> world_from_body(all.robot->bodies().size());
    forward_kinematics(*all.robot, moved, world_from_body);
    return Quaterniond(world_from_body[all.body(task.body)].rotation *
                       task.link_from_body.conjugate());
  };
  return (world_from_link(0.0).conjugate() * world_from_link(0.1)).vec().normalized();
}

void expect_only_rotation_about(const ModelledRobot& all, Bone bone, const std::string& joint) {
  const FitTask& hand = all.task(bone);
  EXPECT_EQ(hand.rotation_weight, 0.0) << hand.body;
  EXPECT_GT(hand.twist_weight, 0.0) << hand.body;
  EXPECT_GT(hand.height_weight, 0.0) << hand.body;
  EXPECT_LT((hand.twist_axis - axis_of(all, joint, hand)).norm(), 1e-6) << hand.body;
}

TEST(ArmTasks, AHandBehindOneWristJointRotatesAboutItsAxis) {
  const ModelledRobot n1 = modelled("fourier_n1");
  expect_only_rotation_about(n1, Bone::kLeftHand, "left_wrist_yaw_joint");
  expect_only_rotation_about(n1, Bone::kRightHand, "right_wrist_yaw_joint");
  const ModelledRobot pm01 = modelled("engineai_pm01");
  expect_only_rotation_about(pm01, Bone::kLeftHand, "J17_ELBOW_YAW_L");
  expect_only_rotation_about(pm01, Bone::kRightHand, "J22_ELBOW_YAW_R");
}

TEST(ArmTasks, HeldWristJointsDoNotCount) {
  const ModelledRobot pm01 = modelled("engineai_pm01", {{"J17_ELBOW_YAW_L", 0.2}});
  EXPECT_FALSE(pm01.task(Bone::kLeftHand).follows_rotation());
  expect_only_rotation_about(pm01, Bone::kRightHand, "J22_ELBOW_YAW_R");

  const ModelledRobot g1 =
      modelled("unitree_g1", {{"left_wrist_pitch_joint", 0.7}, {"left_wrist_yaw_joint", -0.9}});
  expect_only_rotation_about(g1, Bone::kLeftHand, "left_wrist_roll_joint");
}

TEST(ArmTasks, AHandBehindSeveralWristJointsFollowsTheWholeRotation) {
  const ModelledRobot g1 = modelled("unitree_g1", {{"left_wrist_pitch_joint", 0.7}});
  for (const Bone bone : {Bone::kLeftHand, Bone::kRightHand}) {
    EXPECT_GT(g1.task(bone).rotation_weight, 0.0);
    EXPECT_EQ(g1.task(bone).rotation_weight, g1.task(bone).twist_weight);
  }
}

// Directions of the forearms of a fitted motion, from elbow to hand, in the world frame.
std::vector<Vector3d> forearms(const Clip& clip, const ModelledRobot& all) {
  const RobotClip motion = value_of(fit(clip, lafan1_calibration(clip.skeleton()), all.robot,
                                        all.config, all.limits, FitOptions{}))
                               .clip;
  std::vector<Vector3d> directions;
  std::vector<Pose> world_from_body(all.robot->bodies().size());
  for (int t = 0; t < motion.frame_count(); ++t) {
    forward_kinematics(*all.robot, motion.qpos(t), world_from_body);
    for (const auto& [elbow, hand] : {std::pair{Bone::kLeftForeArm, Bone::kLeftHand},
                                      std::pair{Bone::kRightForeArm, Bone::kRightHand}}) {
      const Vector3d start = world_from_body[all.body(all.task(elbow).body)].translation;
      const Vector3d end = world_from_body[all.body(all.task(hand).body)].translation;
      directions.push_back((end - start).normalized());
    }
  }
  return directions;
}

// A robot without a joint for the bend of the wrist moved its forearms by more than 10 degrees.
TEST(ArmTasks, BentHandsDoNotMoveForearms) {
  const Clip clip = cut(recorded_clip("wave"), 0, 40);
  for (const Vector3d& axis : {Vector3d(Vector3d::UnitY()), Vector3d(Vector3d::UnitZ())}) {
    Clip bent = clip;
    for (int t = 0; t < bent.frame_count(); ++t) {
      for (const char* name : {"LeftHand", "RightHand"}) {
        Quaterniond& hand =
            bent.rotations(t)[static_cast<std::size_t>(*bent.skeleton().find(name))];
        hand = hand * Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 3.0, axis));
      }
    }
    for (const char* name : {"fourier_n1", "engineai_pm01"}) {
      const ModelledRobot all = modelled(name);
      const std::vector<Vector3d> before = forearms(clip, all), after = forearms(bent, all);
      double largest = 0.0;
      for (std::size_t k = 0; k < before.size(); ++k) {
        largest = std::max(largest, std::acos(std::min(1.0, before[k].dot(after[k]))));
      }
      EXPECT_LT(largest * 180.0 / std::numbers::pi, 3.0) << name << " " << axis.transpose();
    }
  }
}

}  // namespace
}  // namespace retarget
