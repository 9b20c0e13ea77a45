#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace retarget {

/// A hinge of a left limb in the zero configuration: world axes, metres, radians.
struct BuiltJoint {
  std::string name;
  Eigen::Vector3d axis;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< Position relative to the previous joint.
  double lower = -2.0, upper = 2.0;
  std::string type = "hinge";
  std::optional<Eigen::Vector3d> centre =
      std::nullopt;        ///< Centre of mass; default: halfway to the next joint.
  double mass = 1.0;       ///< Kilograms.
  bool same_axis = false;  ///< The right axis equals the left one instead of its mirror image.
};

/// A left limb; the right limb is its mirror image.
struct BuiltLimb {
  std::vector<BuiltJoint> joints;
  /// Position of wrist or ankle relative to the last joint.
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  bool marked = true;  ///< Whether a body is fixed at the end.
  /// Whether the last segment has its mass in its middle; otherwise it has almost no mass.
  bool heavy = true;
  std::string more;  ///< MJCF inside the last body.
};

inline const Eigen::Vector3d kAxisX{1, 0, 0}, kAxisY{0, 1, 0}, kAxisZ{0, 0, 1};

/// A humanoid whose root, the pelvis or the torso, is at a height of 1 m.
struct BuiltHumanoid {
  BuiltLimb leg, arm;
  std::string before;  ///< MJCF in front of the world.
  std::string after;   ///< MJCF after the world.
  std::string root = "<freejoint/>";
  std::string pelvis = "pos=\"0 0 1\"";
  Eigen::Vector3d hip{0.0, 0.1, -0.05};      ///< Position of the first left joint in the pelvis.
  Eigen::Vector3d shoulder{0.0, 0.15, 0.4};  ///< Position of the first left joint in the torso.
  std::vector<BuiltJoint> waist;             ///< Joints from the root outwards.
  bool torso_is_root = false;
  bool right_leg_first = false;  ///< The model lists the right leg before the left one.

  [[nodiscard]] std::string mjcf() const;
};

inline std::string text_of(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

inline std::string limb_text(const BuiltLimb& limb, const std::string& side,
                             const Eigen::Vector3d& place) {
  const double sign = side == "left" ? 1.0 : -1.0;
  const auto mirrored = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(v.x(), sign * v.y(), v.z());
  };
  const auto mass = [](const Eigen::Vector3d& at, double kg) {
    return fmt::format("<inertial pos=\"{}\" mass=\"{}\" diaginertia=\"1e-2 1e-2 1e-2\"/>",
                       text_of(at), kg);
  };
  std::string text;
  for (std::size_t i = 0; i < limb.joints.size(); ++i) {
    const BuiltJoint& joint = limb.joints[i];
    const bool last = i + 1 == limb.joints.size();
    const Eigen::Vector3d next = last ? limb.end : limb.joints[i + 1].at;
    // Mirroring reverses the sign of rotation axes.
    const double turn = joint.same_axis ? 1.0 : sign;
    const Eigen::Vector3d axis(turn * joint.axis.x(), joint.axis.y(), turn * joint.axis.z());
    const Eigen::Vector3d centre = joint.centre.value_or(0.5 * next);
    text += fmt::format(
        "<body name=\"{0}_{1}\" pos=\"{2}\"><joint name=\"{0}_{1}\" type=\"{3}\" axis=\"{4}\" "
        "range=\"{5} {6}\"/>",
        side, joint.name, text_of(i == 0 ? mirrored(place + joint.at) : mirrored(joint.at)),
        joint.type, text_of(axis), joint.lower, joint.upper);
    text += last && !limb.heavy ? mass(Eigen::Vector3d::Zero(), 1e-6)
                                : mass(mirrored(centre), joint.mass);
  }
  text += limb.more;
  if (limb.marked) {
    text += fmt::format("<body name=\"{}_end_of_{}\" pos=\"{}\">{}</body>", side,
                        limb.joints.back().name, text_of(mirrored(limb.end)),
                        mass(Eigen::Vector3d::Zero(), 0.1));
  }
  for (std::size_t i = 0; i < limb.joints.size(); ++i) text += "</body>";
  return text;
}

inline std::string BuiltHumanoid::mjcf() const {
  const std::string mass = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
  const auto limbs = [&](const BuiltLimb& limb, const Eigen::Vector3d& place) {
    const std::string left = limb_text(limb, "left", place);
    const std::string right = limb_text(limb, "right", place);
    return right_leg_first && &limb == &leg ? right + left : left + right;
  };
  std::string text = "<mujoco>" + before + "<compiler angle=\"radian\"/><worldbody><body name=\"" +
                     (torso_is_root ? "torso" : "pelvis") + "\" " + pelvis + ">" + root + mass;
  text += torso_is_root ? limbs(arm, shoulder) : limbs(leg, hip);
  for (std::size_t i = 0; i < waist.size(); ++i) {
    const BuiltJoint& joint = waist[i];
    const bool last = torso_is_root && i + 1 == waist.size();
    text += fmt::format(
        "<body name=\"{}\" pos=\"{}\"><joint name=\"{}\" axis=\"{}\" range=\"{} {}\"/>{}",
        last ? "pelvis" : joint.name, text_of(joint.at), joint.name, text_of(joint.axis),
        joint.lower, joint.upper, mass);
  }
  text += torso_is_root ? limbs(leg, hip)
                        : "<body name=\"torso\">" + mass + limbs(arm, shoulder) + "</body>";
  for (std::size_t i = 0; i < waist.size(); ++i) text += "</body>";
  return text + "</body></worldbody>" + after + "</mujoco>";
}

/// A leg with three hip joints, knee, and two ankle joints: thigh 0.2 m, shin 0.25 m.
inline BuiltLimb plain_leg() {
  BuiltLimb leg;
  leg.joints = {{"hip_pitch", kAxisY},
                {"hip_roll", kAxisX, {0, 0, 0}, -0.6, 0.8},
                {"hip_yaw", kAxisZ, {0, 0, 0}, -1, 1},
                {"knee", kAxisY, {0, 0, -0.2}, 0, 2.4},
                {"ankle_pitch", kAxisY, {0, 0, -0.25}, -1, 0.8},
                {"ankle_roll", kAxisX, {0, 0, 0}, -0.4, 0.4}};
  leg.marked = false;
  leg.more = "<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
  return leg;
}

/// A hanging arm with three shoulder joints, elbow and hand: upper arm 0.18 m, forearm 0.15 m.
inline BuiltLimb plain_arm() {
  BuiltLimb arm;
  arm.joints = {{"shoulder_pitch", kAxisY, {0, 0, 0}, -3, 3},
                {"shoulder_roll", kAxisX, {0, 0, 0}, -0.3, 2.8},
                {"shoulder_yaw", kAxisZ},
                {"elbow", -kAxisY, {0, 0, -0.18}, 0, 2.2}};
  arm.end = {0, 0, -0.15};
  return arm;
}

inline BuiltHumanoid plain_humanoid() {
  BuiltHumanoid built;
  built.leg = plain_leg();
  built.arm = plain_arm();
  return built;
}

}  // namespace retarget
