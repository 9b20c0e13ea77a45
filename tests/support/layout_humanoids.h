#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "support/built_humanoids.h"

namespace retarget {

/// True directions of a left limb in the zero configuration, world axes.
struct KnownLimb {
  std::string upper, lower;  ///< Joints whose bodies are the two segments.
  /// From hip to knee to ankle, or from shoulder to elbow to wrist.
  Eigen::Vector3d upper_way, lower_way;
};

/// A robot with the joint layout of a published robot, and the true directions of its limbs.
struct LayoutHumanoid {
  std::string name;
  BuiltHumanoid built;
  KnownLimb leg, arm;
};

/// Geometry for the last body of a leg: a foot whose sole is below the ankle and extends forwards.
inline std::string foot_box(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_size) {
  return fmt::format("<geom type=\"box\" pos=\"{}\" size=\"{}\"/>", text_of(centre),
                     text_of(half_size));
}

/// HighTorque's Pi Plus with five arm joints. The last one turns the forearm, a quarter of an upper
/// arm beyond the elbow. No body is fixed to the forearm; knees and elbows bend both ways.
inline LayoutHumanoid pi_plus_layout() {
  LayoutHumanoid robot{"pi_plus", {}, {}, {}};
  robot.built.hip = {0, 0.0475, -0.0435};
  robot.built.leg.joints = {
      {"hip_pitch", kAxisY, {0, 0, 0}, -3.12, 2.94},
      {"hip_roll", kAxisX, {0, 0.034, 0}, -0.31, 3.14},
      {"thigh", kAxisZ, {0, 0, -0.0977}, -2.87, 2.87},
      {"calf", kAxisY, {0, 0, -0.045}, -2.49, 2.49},
      {"ankle_pitch", kAxisY, {0, 0, -0.14}, -0.97, 0.92},
      {"ankle_roll", kAxisX, {0.051, 0, 0}, -0.78, 0.78},
  };
  robot.built.leg.marked = false;
  robot.built.leg.more = foot_box({-0.03, 0, -0.03}, {0.08, 0.03, 0.005});
  robot.built.shoulder = {0, 0.1069, 0.117};
  robot.built.arm.joints = {
      {"shoulder_pitch", kAxisY, {0, 0, 0}, -4.18, 1.04, "hinge", {{0, 0.019, 0}}, 0.142},
      {"shoulder_roll", kAxisX, {0, 0.038, 0}, -0.13, 3.0, "hinge", {{0, 0, -0.022}}, 0.492},
      {"upper_arm", kAxisZ, {0, 0, -0.0724}, -2.16, 2.16, "hinge", {{0, 0, -0.014}}, 0.162},
      {"elbow", kAxisY, {0, 0, -0.038}, -2, 2, "hinge", {{0, 0.002, -0.002}}, 0.283},
      {"wrist", kAxisZ, {0, 0, -0.029}, 0, 0, "hinge", {{0, 0, -0.042}}, 0.073},
  };
  robot.built.arm.marked = false;
  robot.leg = {"thigh", "calf", -kAxisZ, -kAxisZ};
  robot.arm = {"upper_arm", "elbow", -kAxisZ, -kAxisZ};
  return robot;
}

/// RoboParty's ATOM01. The yaw and roll axes of its hips lean by 30 degrees. The forearms point
/// forwards in the zero configuration and have no wrist, only a twist joint.
inline LayoutHumanoid atom01_layout() {
  LayoutHumanoid robot{"atom01", {}, {}, {}};
  robot.built.waist = {{"torso_yaw", kAxisZ, {-0.028, 0, 0.0672}, -3.14, 3.14}};
  robot.built.hip = {-0.0711, 0.0725, -0.0518};
  const Eigen::Vector3d yaw(-0.5, 0, -0.86603), roll(0.86603, 0, -0.5);
  robot.built.leg.joints = {
      {"thigh_yaw", yaw, {0, 0, 0}, -1, 0.2},
      {"thigh_roll", roll, {-0.0183, 0, -0.072}, -0.2, 1},
      {"thigh_pitch", kAxisY, {0.0612, 0.02085, -0.0354}, -1, 1},
      {"knee", kAxisY, {0, 0, -0.25}, -0.2, 2.5},
      {"ankle_pitch", kAxisY, {0, -0.02085, -0.3}, -0.6, 0.6},
      {"ankle_roll", kAxisX, {0, 0, 0}, -0.5, 0.5},
  };
  robot.built.leg.marked = false;
  robot.built.leg.more = foot_box({0.03, 0, -0.035}, {0.1, 0.04, 0.005});
  robot.built.shoulder = {0, 0.12175, 0.20618};
  robot.built.arm.joints = {
      {"arm_pitch", kAxisY, {0, 0, 0}, -3.14, 1.57, "hinge", {{-0.004, 0.05, 0}}, 0.472},
      {"arm_roll", kAxisX, {0.02, 0.056, 0}, -0.25, 3.14, "hinge", {{-0.004, 0, -0.024}}, 0.092},
      {"arm_yaw", -kAxisZ, {-0.02, 0, -0.05}, -1.57, 1.57, "hinge", {{0, -0.002, -0.106}}, 1.153},
      {"elbow_pitch", kAxisY, {0, 0.02, -0.18875}, -0.6, 1.57, "hinge", {{0.024, 0, 0}}, 0.092},
      {"elbow_yaw", kAxisX, {0.05, -0.02, 0}, -1.57, 1.57, "hinge", {{0.053, 0, 0}}, 0.681},
  };
  robot.built.arm.marked = false;
  robot.leg = {"thigh_pitch", "knee", -kAxisZ, -kAxisZ};
  robot.arm = {"arm_yaw", "elbow_pitch", -kAxisZ, kAxisX};
  return robot;
}

/// K-Scale's Z-Bot. The shoulders have two joints. The elbow axis is parallel to the shoulder's
/// roll axis; by its range, the elbow bends inwards on the left and outwards on the right. It has
/// grippers. The anchors of knees and elbows are far from the limb's line, along their axes.
inline LayoutHumanoid z_bot_layout() {
  LayoutHumanoid robot{"z_bot", {}, {}, {}};
  robot.built.hip = {0, 0.043, -0.0893};
  robot.built.leg.joints = {
      {"hip_yaw", kAxisZ, {0, 0, 0}, -1.57, 1.57, "hinge", {}, 0.03},
      {"hip_roll", kAxisX, {-0.02, 0, -0.0267}, -0.61, 0.61, "hinge", {{0, 0, -0.013}}, 0.217},
      {"hip_pitch", kAxisY, {0.0162, -0.0198, 0}, -1.57, 0.87, "hinge", {}, 0.031},
      {"knee", -kAxisY, {0, 0.0013, -0.1}, -1.4, 1.4, "hinge", {{0, 0.018, -0.024}}, 0.134},
      {"ankle_pitch",
       kAxisY,
       {0, 0.0365, -0.1},
       -1.4,
       0.7,
       "hinge",
       {{-0.016, -0.018, 0.013}},
       0.217},
      {"ankle_roll",
       -kAxisX,
       {-0.0152, -0.0188, 0},
       -1.05,
       1.05,
       "hinge",
       {{0.011, 0, -0.026}},
       0.097},
  };
  robot.built.leg.marked = false;
  robot.built.leg.more = foot_box({0.026, 0.007, -0.0113}, {0.0517, 0.037, 0.0213});
  robot.built.shoulder = {0, 0.0603, 0.0261};
  robot.built.arm.joints = {
      {"shoulder_pitch", -kAxisY, {0, 0, 0}, -1.57, 3.14, "hinge", {{0, 0.014, 0}}, 0.019},
      {"shoulder_roll",
       -kAxisX,
       {-0.018, 0.0327, -0.0041},
       -2.62,
       0.4,
       "hinge",
       {{0.019, 0, -0.043}},
       0.122},
      {"elbow_roll",
       -kAxisX,
       {0.0386, 0, -0.0862},
       -0.873,
       1.571,
       "hinge",
       {{-0.019, 0.003, -0.056}},
       0.153},
      {"gripper",
       kAxisX,
       {-0.0383, 0.0118, -0.0663},
       -0.52,
       0.52,
       "hinge",
       {{0.019, 0.02, -0.028}},
       0.022},
  };
  robot.built.arm.joints[2].same_axis = true;
  robot.built.arm.marked = false;
  robot.leg = {"hip_pitch", "knee", -kAxisZ, -kAxisZ};
  robot.arm = {"shoulder_roll", "elbow_roll", Eigen::Vector3d(0, 0, -0.0862),
               Eigen::Vector3d(0, 0.0118, -0.0663)};
  return robot;
}

/// Fourier's QingLong. The chest is the root, the arms point sideways in the zero configuration,
/// and no joint of trunk, arms and legs has a range.
inline LayoutHumanoid qing_long_layout() {
  LayoutHumanoid robot{"qing_long", {}, {}, {}};
  robot.built.torso_is_root = true;
  robot.built.waist = {{"waist_pitch", -kAxisY, {0, -0.065, 0}, 0, 0},
                       {"waist_roll", kAxisX, {-0.064, 0.065, 0}, 0, 0},
                       {"waist_yaw", kAxisZ, {0.0675, 0, -0.098}, 0, 0}};
  robot.built.hip = {-0.0875, 0.12, -0.069};
  robot.built.leg.joints = {
      {"hip_roll", kAxisX, {0, 0, 0}, 0, 0},
      {"hip_yaw", -kAxisZ, {0.0823, 0, -0.01}, 0, 0},
      {"hip_pitch", -kAxisY, {0, -0.0368, -0.1055}, 0, 0},
      {"knee", kAxisY, {0, 0.0113, -0.4}, 0, 0},
      {"ankle_pitch", kAxisY, {0, 0, -0.387}, 0, 0},
      {"ankle_roll", kAxisX, {0, 0, 0}, 0, 0},
  };
  robot.built.leg.marked = false;
  robot.built.leg.more = foot_box({0.0475, 0, -0.0265}, {0.1225, 0.04, 0.0435});
  robot.built.shoulder = {0.004, 0.1616, 0.3922};
  robot.built.arm.joints = {
      {"arm_01", kAxisY, {0, 0, 0}, 0, 0, "hinge", {{0, 0.038, 0}}, 0.489},
      {"arm_02", -kAxisX, {-0.0416, 0.041, 0}, 0, 0, "hinge", {{0.042, 0.067, 0}}, 0.438},
      {"arm_03", kAxisY, {0.0416, 0.1226, 0}, 0, 0, "hinge", {{0.001, 0.145, 0.016}}, 0.527},
      {"arm_04", kAxisX, {-0.0353, 0.1774, 0.024}, 0, 0, "hinge", {{0.039, 0.06, -0.021}}, 0.252},
      {"arm_05", kAxisY, {0.0353, 0.1035, -0.024}, 0, 0, "hinge", {{-0.002, 0.084, 0}}, 0.169},
      {"arm_06", kAxisX, {-0.0265, 0.1968, 0}, 0, 0, "hinge", {{0.026, 0, 0.002}}, 0.055},
      {"arm_07", kAxisZ, {0.0265, 0, 0.0318}, 0, 0, "hinge", {{0, 0.037, -0.028}}, 0.042},
  };
  robot.built.arm.end = {0, 0.08, 0};
  robot.leg = {"hip_pitch", "knee", -kAxisZ, -kAxisZ};
  robot.arm = {"arm_03", "arm_04", kAxisY, kAxisY};
  return robot;
}

/// The names have no meaning. The shoulder axes miss each other by a sixth of the upper arm, the
/// elbows are offset from the axis that turns the upper arm, and there is no wrist.
inline LayoutHumanoid offset_shoulder_layout() {
  LayoutHumanoid robot{"offset_shoulder", plain_humanoid(), {}, {}};
  robot.built.arm.joints = {
      {"a0", kAxisY, {0, 0, 0}, -3, 1.1, "hinge", {}, 0.3},
      {"a1", kAxisX, {-0.012, 0.024, 0}, -0.3, 2.5, "hinge", {}, 1},
      {"a2", kAxisZ, {0.003, -0.005, -0.003}, -1.6, 1.6, "hinge", {}, 0.5},
      {"a3", -kAxisY, {-0.008, 0, -0.11}, 0, 2.2, "hinge", {}, 0.3},
  };
  robot.built.arm.end = {0, 0, -0.08};
  robot.leg = {"hip_yaw", "knee", -kAxisZ, -kAxisZ};
  robot.arm = {"a2", "a3", Eigen::Vector3d(-0.008, 0, -0.11), -kAxisZ};
  return robot;
}

/// Three hinges at the same position, in the order of the letters.
inline std::vector<BuiltJoint> ball_of_hinges(const std::string& name, const Eigen::Vector3d& at,
                                              const std::string& order = "xyz") {
  std::vector<BuiltJoint> hinges;
  for (const char letter : order) {
    const Eigen::Vector3d& axis = letter == 'x' ? kAxisX : letter == 'y' ? kAxisY : kAxisZ;
    const Eigen::Vector3d place = hinges.empty() ? at : Eigen::Vector3d(Eigen::Vector3d::Zero());
    hinges.push_back({name + "_" + letter, axis, place, -3.14, 3.14});
  }
  return hinges;
}

/// A humanoid like those of SMPL or SOMA: every joint, including the toes, consists of three
/// hinges; the arms point sideways.
/// @param toe_ends  whether the ends of the toes are joints as well.
inline LayoutHumanoid smpl_layout(const std::string& order = "xyz", bool toe_ends = false) {
  LayoutHumanoid robot{"smpl", {}, {}, {}};
  const auto chain = [&](std::vector<std::pair<std::string, Eigen::Vector3d>> places) {
    std::vector<BuiltJoint> joints;
    for (const auto& [name, at] : places) {
      for (BuiltJoint& joint : ball_of_hinges(name, at, order)) joints.push_back(std::move(joint));
    }
    return joints;
  };
  robot.built.waist = ball_of_hinges("chest", {0, 0, 0.2});
  robot.built.hip = {0, 0.07, -0.09};
  robot.built.leg.joints = chain({{"hip", {0, 0, 0}},
                                  {"knee", {0, 0.02, -0.38}},
                                  {"ankle", {-0.04, -0.01, -0.4}},
                                  {"toe", {0.12, 0.03, -0.06}}});
  if (toe_ends) {
    for (const BuiltJoint& joint : ball_of_hinges("toe_end", {0.05, 0, -0.01}, order)) {
      robot.built.leg.joints.push_back(joint);
    }
  }
  robot.built.leg.end = {0.04, 0, 0};
  robot.built.leg.marked = false;
  robot.built.leg.more = foot_box({0.03, 0, 0}, {0.05, 0.04, 0.02});
  robot.built.shoulder = {0, 0.17, 0.3};
  robot.built.arm.joints =
      chain({{"shoulder", {0, 0, 0}}, {"elbow", {-0.01, 0.25, 0}}, {"wrist", {0, 0.25, 0}}});
  robot.built.arm.end = {0, 0.08, 0};
  const std::string last = std::string("_") + order.back();
  robot.leg = {"hip" + last, "knee" + last, Eigen::Vector3d(0, 0.02, -0.38),
               Eigen::Vector3d(-0.04, -0.01, -0.4)};
  robot.arm = {"shoulder" + last, "elbow" + last, Eigen::Vector3d(-0.01, 0.25, 0), kAxisY};
  return robot;
}

/// An arm of seven joints with a hand that has two more wrist joints.
inline LayoutHumanoid wristed_hand_layout() {
  LayoutHumanoid robot{"wristed_hand", plain_humanoid(), {}, {}};
  robot.built.arm.joints = {
      {"shoulder_pitch", kAxisY, {0, 0, 0}, -3, 3},
      {"shoulder_roll", kAxisX, {0, 0.03, 0}, -0.3, 2.8},
      {"shoulder_yaw", kAxisZ, {0, 0, -0.1}},
      {"elbow", -kAxisY, {0, 0, -0.13}, 0, 2.2},
      {"wrist_yaw", kAxisZ, {0, 0, -0.0675}},
      {"wrist_roll", kAxisX, {0, 0, -0.0825}, -0.6, 0.6},
      {"wrist_pitch", kAxisY, {0, 0, -0.03}, -1, 1},
      {"hand_wrist_pitch", kAxisX, {0, 0, -0.2}, -0.5, 0.2},
      {"hand_wrist_roll", kAxisY, {0, 0, -0.034}, -0.7, 0.5},
  };
  robot.built.arm.end = {0, 0, -0.09};
  robot.leg = {"hip_yaw", "knee", -kAxisZ, -kAxisZ};
  robot.arm = {"shoulder_yaw", "elbow", -kAxisZ, -kAxisZ};
  return robot;
}

}  // namespace retarget
