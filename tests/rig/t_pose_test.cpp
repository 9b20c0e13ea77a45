#include "solve/robot_setup/t_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "retarget/kinematic_tree.h"
#include "solve/robot_setup/derive_config.h"
#include "support/built_humanoids.h"
#include "support/humanoids.h"
#include "support/value_of.h"

namespace retarget {
namespace {

TEST(SolveTPose, RobotInATPoseKeepsItsZeroPose) {
  const auto robot = robot_from_text(tiny_humanoid(false));
  const auto limbs = value_of(find_limbs(*robot, ""));
  const TPose pose = solve_t_pose(*robot, limbs);
  const std::vector<double> zero = robot->zero_configuration();
  for (std::size_t i = 0; i < zero.size(); ++i) EXPECT_NEAR(pose.qpos[i], zero[i], 1e-6) << i;
  for (const TPoseResidual& residual : pose.residuals) {
    EXPECT_NEAR(residual.direction, 0.0, 1e-6) << residual.bone;
    EXPECT_NEAR(residual.twist, 0.0, 1e-6) << residual.bone;
  }
}

TEST(SolveTPose, RaisesHangingArms) {
  const auto robot = robot_from_text(tiny_humanoid(true));
  const auto limbs = value_of(find_limbs(*robot, ""));
  const TPose pose = solve_t_pose(*robot, limbs);
  for (const TPoseResidual& residual : pose.residuals) {
    EXPECT_LT(residual.direction, 1e-3) << residual.bone;
    EXPECT_LT(residual.twist, 1e-3) << residual.bone;
  }
  // In closed form: the roll joints rotate by a quarter turn, all others do not move.
  for (const RobotJoint& joint : robot->joints()) {
    const double expected = joint.name == "left_shoulder_roll"    ? 0.5 * std::numbers::pi
                            : joint.name == "right_shoulder_roll" ? -0.5 * std::numbers::pi
                                                                  : 0.0;
    EXPECT_NEAR(pose.qpos[static_cast<std::size_t>(joint.qpos_address)], expected, 2e-3)
        << joint.name;
  }
}

TEST(SolveTPose, ReportsDeviationsCausedByLimits) {
  std::string text = tiny_humanoid(true);
  const std::string range = "-0.3 2.5";
  text.replace(text.find(range), range.size(), "-0.3 1.0");
  const auto robot = robot_from_text(text);
  const auto limbs = value_of(find_limbs(*robot, ""));
  const TPose pose = solve_t_pose(*robot, limbs);
  for (const TPoseResidual& residual : pose.residuals) {
    // Roll alone raises the arm; the rest of the right angle remains, except for a slight turn of
    // the waist that helps.
    if (residual.bone == "LeftArm") {
      EXPECT_NEAR(residual.direction, 0.5 * std::numbers::pi - 1.0, 0.1);
    }
    if (residual.bone == "Spine2") {
      EXPECT_LT(residual.twist, 0.1);
    }
    if (residual.bone == "RightArm") {
      EXPECT_LT(residual.direction, 0.1);
    }
  }
}

// A thigh exactly half a turn off about its axis is at a saddle of the cost.
TEST(SolveTPose, EscapesAStartHalfATurnOff) {
  BuiltHumanoid built = plain_humanoid();
  for (BuiltJoint& joint : built.leg.joints) {
    if (joint.name != "hip_yaw") continue;
    joint.lower = -3.3;
    joint.upper = 3.3;
  }
  const auto robot = robot_from_text(built.mjcf());
  auto limbs = find_limbs(*robot, "").value();
  const Eigen::Matrix3d half_turn =
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const TreeState posed(robot->tree(), robot->zero_configuration());
  for (Limb& leg : limbs.legs) {
    for (LimbPart* part : {&leg.upper, &leg.lower, &*leg.end}) {
      const Eigen::Matrix3d world_from_body =
          posed.world_from_body(part->body).rotation.toRotationMatrix();
      part->body_from_bone =
          world_from_body.transpose() * half_turn * world_from_body * part->body_from_bone;
    }
  }
  const TPose pose = solve_t_pose(*robot, limbs);
  for (const TPoseResidual& residual : pose.residuals) {
    EXPECT_LT(residual.direction, 1e-3) << residual.bone;
    EXPECT_LT(residual.twist, 1e-3) << residual.bone;
  }
}

TEST(DeriveConfig, OffsetsMapTheHumanTPoseToTheRobotTPose) {
  for (const bool arms_down : {false, true}) {
    const auto robot = robot_from_text(tiny_humanoid(arms_down));
    const auto limbs = value_of(find_limbs(*robot, ""));
    const TPose pose = solve_t_pose(*robot, limbs);
    std::vector<Pose> world_from_body(robot->bodies().size());
    forward_kinematics(*robot, pose.qpos, world_from_body);
    const RetargetingConfig config = derive_config(*robot, limbs);
    ASSERT_EQ(config.match_tables[0].rows.size(), 14U);
    for (const BonePart& part : bone_parts(limbs)) {
      const std::string& body = robot->bodies()[static_cast<std::size_t>(part.part.body)].name;
      for (const IkMatch& row : config.match_tables[0].rows) {
        if (row.body != body) continue;
        const Eigen::Matrix3d target =
            t_pose_of(limbs, part.bone) * row.rotation_offset.toRotationMatrix();
        const Eigen::Matrix3d found =
            world_from_body[static_cast<std::size_t>(part.part.body)].rotation.toRotationMatrix();
        EXPECT_NEAR((target - found).norm(), 0.0, 5e-3) << row.body;
      }
    }
  }
}

TEST(DeriveConfig, StraightLegsStayStraight) {
  const auto robot = robot_from_text(tiny_humanoid(true));
  const auto limbs = value_of(find_limbs(*robot, ""));
  const HumanLengths human;
  const DerivedScales scales = derive_scales(limbs);
  EXPECT_NEAR(scales.leg * (human.thigh + human.shin), 0.45, 1e-9);
  EXPECT_NEAR(scales.arm * (human.upper_arm + human.forearm), 0.33, 1e-9);
}

TEST(DeriveConfig, RoundTrips) {
  const auto robot = robot_from_text(tiny_humanoid(true));
  const auto limbs = value_of(find_limbs(*robot, ""));
  const RetargetingConfig config = derive_config(*robot, limbs);
  const auto read =
      value_of(parse_retargeting_config(format_retargeting_config(config), "ik.json"));
  EXPECT_TRUE(resolve_config(read, *robot));
  ASSERT_EQ(read.scales, config.scales);
  for (std::size_t t = 0; t < 2; ++t) {
    ASSERT_EQ(read.match_tables[t].rows.size(), config.match_tables[t].rows.size());
    for (std::size_t i = 0; i < config.match_tables[t].rows.size(); ++i) {
      const IkMatch& found = read.match_tables[t].rows[i];
      const IkMatch& expected = config.match_tables[t].rows[i];
      EXPECT_EQ(found.body, expected.body);
      EXPECT_EQ(found.position_weight, expected.position_weight);
      EXPECT_EQ(found.rotation_weight, expected.rotation_weight);
      EXPECT_NEAR((found.position_offset - expected.position_offset).norm(), 0.0, 1e-5);
      EXPECT_NEAR((found.rotation_offset.coeffs() - expected.rotation_offset.coeffs()).norm(), 0.0,
                  1e-7);
    }
  }
}

TEST(SolveTPose, ReportsABodyThatIsNotFinite) {
  const auto robot = robot_from_text(tiny_humanoid(true));
  auto limbs = value_of(find_limbs(*robot, ""));
  limbs.forward.setConstant(std::numeric_limits<double>::quiet_NaN());
  const TPose pose = solve_t_pose(*robot, limbs);
  for (const double value : pose.qpos) EXPECT_TRUE(std::isfinite(value));
  EXPECT_TRUE(t_pose_fault(*robot, pose));
}

}  // namespace
}  // namespace retarget
