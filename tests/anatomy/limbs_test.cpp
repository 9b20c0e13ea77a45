#include "robot/anatomy/limbs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/built_humanoids.h"
#include "support/humanoids.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string body_name(const Robot& robot, int body) {
  return robot.bodies()[static_cast<std::size_t>(body)].name;
}

std::vector<int> bodies_of(const RobotAnatomy& limbs) {
  std::vector<int> bodies = {limbs.pelvis, limbs.torso};
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      bodies.insert(bodies.end(), {limb.upper.body, limb.lower.body, limb.end->body});
    }
  }
  return bodies;
}

// The error of a rejected model.
std::string refusal(const std::string& mjcf) {
  const auto robot = robot_from_text(mjcf);
  const auto limbs = find_limbs(*robot, "robot.xml");
  EXPECT_FALSE(limbs.has_value());
  if (limbs) return {};
  EXPECT_EQ(limbs.error().kind, ErrorKind::kConfig);
  return limbs.error().message;
}

TEST(FindLimbs, FindsEveryPartOfAHumanoid) {
  for (const bool arms_down : {false, true}) {
    const auto robot = robot_from_text(tiny_humanoid(arms_down));
    const auto limbs = value_of(find_limbs(*robot, ""));
    EXPECT_EQ(body_name(*robot, limbs.pelvis), "pelvis");
    EXPECT_EQ(body_name(*robot, limbs.torso), "torso");
    EXPECT_TRUE(limbs.facing_is_sure);
    EXPECT_NEAR((limbs.forward - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-12);
    for (std::size_t side = 0; side < 2; ++side) {
      const std::string name = side == 0 ? "left_" : "right_";
      const Limb& leg = limbs.legs[side];
      EXPECT_EQ(body_name(*robot, leg.upper.body), name + "thigh");
      EXPECT_EQ(body_name(*robot, leg.lower.body), name + "shin");
      EXPECT_EQ(body_name(*robot, leg.end->body), name + "foot");
      EXPECT_NEAR(leg.upper_length, 0.2, 1e-9);
      EXPECT_NEAR(leg.lower_length, 0.25, 1e-9);
      EXPECT_NEAR(leg.straight, 0.0, 1e-9);
      EXPECT_EQ(leg.flexion, 1.0);
      const Limb& arm = limbs.arms[side];
      EXPECT_EQ(body_name(*robot, arm.upper.body), name + "upper_arm");
      EXPECT_EQ(body_name(*robot, arm.lower.body), name + "forearm");
      EXPECT_EQ(body_name(*robot, arm.end->body), name + "hand");
      EXPECT_NEAR(arm.upper_length, 0.18, 1e-9);
      EXPECT_NEAR(arm.lower_length, 0.15, 1e-9);
    }
  }
}

TEST(FindLimbs, IgnoresNames) {
  const auto named = robot_from_text(tiny_humanoid(true));
  const auto scrambled = robot_from_text(scramble_names(tiny_humanoid(true)));
  const auto expected = value_of(find_limbs(*named, ""));
  const auto found = value_of(find_limbs(*scrambled, ""));
  EXPECT_EQ(bodies_of(found), bodies_of(expected));
  EXPECT_NE(body_name(*scrambled, found.pelvis), "pelvis");
}

TEST(FindLimbs, BoneAxesAreTheCanonicalOnes) {
  // T-pose at zero with bodies aligned with the world: the bone axes are the canonical ones.
  const auto robot = robot_from_text(tiny_humanoid(false));
  const auto limbs = value_of(find_limbs(*robot, ""));
  Eigen::Matrix3d leg, left_arm, right_arm, foot;
  leg << -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY();
  foot << Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitY();
  left_arm << Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ();
  right_arm << -Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ();
  EXPECT_NEAR((limbs.legs[0].upper.body_from_bone - leg).norm(), 0.0, 1e-9);
  EXPECT_NEAR((limbs.legs[1].lower.body_from_bone - leg).norm(), 0.0, 1e-9);
  EXPECT_NEAR((limbs.legs[1].end->body_from_bone - foot).norm(), 0.0, 1e-9);
  EXPECT_NEAR((limbs.arms[0].upper.body_from_bone - left_arm).norm(), 0.0, 1e-9);
  EXPECT_NEAR((limbs.arms[1].lower.body_from_bone - right_arm).norm(), 0.0, 1e-9);
}

TEST(FindLimbs, FacingOfTurnedRobotsFollowsTheirKnees) {
  // The same robot, rotated by 90 and 180 degrees about z in its own base frame.
  for (const auto& [quat, forward] :
       {std::pair<std::string, Eigen::Vector3d>{"0.70710678118654757 0 0 0.70710678118654757",
                                                Eigen::Vector3d::UnitY()},
        {"0 0 0 1", -Eigen::Vector3d::UnitX()}}) {
    std::string text = scramble_names(tiny_humanoid(true));
    const std::string base = "pos=\"0 0 0.55\"";
    text.replace(text.find(base), base.size(), base + " quat=\"" + quat + "\"");
    const auto robot = robot_from_text(text);
    const auto limbs = value_of(find_limbs(*robot, ""));
    EXPECT_NEAR((limbs.forward - forward).norm(), 0.0, 1e-9);
    const auto upright = robot_from_text(scramble_names(tiny_humanoid(true)));
    EXPECT_EQ(bodies_of(limbs), bodies_of(*find_limbs(*upright, "")));
  }
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  for (; at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// The anchor of a joint may be anywhere on its axis.
TEST(FindLimbs, AnchorsDoNotTurnRobotsOffTheAxes) {
  std::string text = scramble_names(tiny_humanoid(true));
  for (const char* left_range : {"-0.5 1", "-0.3 2.5"}) {
    const std::string range = std::string("range=\"") + left_range + "\"";
    replace_all(text, range, "pos=\"0.3 0 0\" " + range);
  }
  for (const double degrees : {45.0, 20.0, -137.0}) {
    const double half = 0.5 * degrees * std::numbers::pi / 180.0;
    std::string turned = text;
    replace_all(turned, "pos=\"0 0 0.55\"",
                "pos=\"0 0 0.55\" quat=\"" + std::to_string(std::cos(half)) + " 0 0 " +
                    std::to_string(std::sin(half)) + "\"");
    const auto robot = robot_from_text(turned);
    const auto limbs = find_limbs(*robot, "");
    ASSERT_TRUE(limbs) << degrees << ": " << describe(limbs.error());
    const Eigen::Vector3d forward(std::cos(2.0 * half), std::sin(2.0 * half), 0.0);
    EXPECT_LT((limbs->forward - forward).norm(), 1e-5) << degrees;
  }
}

// The legs are not exact mirror images, because of rounding, so the line across points the other
// way if the model lists the right leg first. The names of seven arm joints outweigh those of six
// leg joints.
TEST(FindLimbs, OrderOfLegsInTheModelDoesNotTurnTheRobot) {
  BuiltHumanoid built = plain_humanoid();
  built.right_leg_first = true;
  built.arm.end = Eigen::Vector3d::Zero();
  built.arm.joints.push_back({"wrist_yaw", kAxisZ, {0, 0, -0.15}});
  built.arm.joints.push_back({"wrist_roll", kAxisX});
  built.arm.joints.push_back({"wrist_pitch", kAxisY});
  for (const bool knees_tell : {true, false}) {
    if (!knees_tell) {
      built.leg.joints[3].lower = -2.4;
      built.leg.more = "<geom type=\"box\" pos=\"0 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
    }
    std::string text = built.mjcf();
    const std::string ankle = "name=\"right_ankle_pitch\" pos=\"0 ";
    ASSERT_NE(text.find(ankle), std::string::npos);
    text.replace(text.find(ankle) + ankle.size() - 2, 1, "1e-17");
    const auto robot = robot_from_text(text);
    const auto limbs = value_of(find_limbs(*robot, ""));
    EXPECT_NEAR((limbs.forward - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-9);
    EXPECT_EQ(body_name(*robot, limbs.arms[0].upper.body), "left_shoulder_yaw");
    EXPECT_EQ(body_name(*robot, limbs.legs[0].upper.body), "left_hip_yaw");
    EXPECT_THAT(limbs.notes, Not(Contains(HasSubstr("named right"))));
  }
}

// The chain of one arm continues into its heavy finger.
TEST(FindLimbs, MassesOfFingersDoNotSeparateArms) {
  BuiltHumanoid built = plain_humanoid();
  built.arm.end = Eigen::Vector3d::Zero();
  built.arm.joints.push_back({"wrist", kAxisZ, {0, 0, -0.15}});
  built.arm.marked = false;
  const auto finger = [](const std::string& place, const std::string& mass) {
    const std::string link =
        "<joint axis=\"0 1 0\" range=\"0 1\"/><inertial pos=\"0 0 -0.01\" mass=\"" + mass +
        "\" diaginertia=\"1e-5 1e-5 1e-5\"/>";
    return "<body pos=\"" + place + "\">" + link + "<body pos=\"0 0 -0.03\">" + link +
           "</body></body>";
  };
  built.arm.more = finger("0.02 0 -0.05", "HEAVY") + finger("-0.02 0 -0.05", "0.01");
  std::string text = built.mjcf();
  for (const std::string mass : {"0.1", "0.1", "0.01", "0.01"}) {
    text.replace(text.find("HEAVY"), 5, mass);  // The left arm comes first.
  }
  const auto robot = robot_from_text(text);
  const auto limbs = value_of(find_limbs(*robot, ""));
  for (const std::size_t side : {0U, 1U}) {
    EXPECT_EQ(limbs.arms[side].joints.size(), 5U);
    EXPECT_EQ(body_name(*robot, limbs.arms[side].end->body),
              side == 0 ? "left_wrist" : "right_wrist");
  }
}

std::string leg_text(const std::string& pos, const std::string& end) {
  return "<body pos=\"" + pos +
         "\"><joint axis=\"1 0 0\" range=\"-1 1\"/><geom size=\"0.02\"/>"
         "<body><joint axis=\"0 1 0\" range=\"-1 1\"/><geom size=\"0.02\"/>"
         "<body pos=\"0 0 -0.2\"><joint axis=\"0 1 0\" range=\"-2 0\"/><geom size=\"0.02\"/>" +
         end + "</body></body></body>";
}

TEST(FindLimbs, RejectsNonHumanoids) {
  const std::string head =
      "<mujoco><compiler angle=\"radian\"/><worldbody><body pos=\"0 0 0.4\"><freejoint/>"
      "<geom size=\"0.1\"/>";
  const std::string tail = "</body></worldbody></mujoco>";
  const std::string foot = "<body pos=\"0 0 -0.2\"><geom size=\"0.02\"/></body>";
  EXPECT_THAT(refusal(head + leg_text("0.2 0.1 0", foot) + leg_text("0.2 -0.1 0", foot) +
                      leg_text("-0.2 0.1 0", foot) + leg_text("-0.2 -0.1 0", foot) + tail),
              HasSubstr("quadruped"));
  EXPECT_THAT(refusal(head + leg_text("0 0 0.1", foot) + tail), HasSubstr("a single arm"));
  EXPECT_THAT(refusal(head + leg_text("0 0.1 0", foot) + leg_text("0 -0.1 0", foot) + tail),
              HasSubstr("one pair of limbs"));
  const std::string wheel =
      "<body pos=\"0 0 -0.2\"><joint axis=\"0 1 0\"/><geom type=\"cylinder\" size=\"0.05 0.02\"/>"
      "</body>";
  EXPECT_THAT(refusal(head + leg_text("0 0.1 0", wheel) + leg_text("0 -0.1 0", wheel) + tail),
              HasSubstr("wheels"));
}

}  // namespace
}  // namespace retarget
