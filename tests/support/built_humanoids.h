#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace retarget {

/// A hinge of a limb on the left side, in the zero configuration: world axes, metres, radians.
struct BuiltJoint {
  std::string name;
  Eigen::Vector3d axis;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< From the joint before it.
  double lower = -2.0, upper = 2.0;
  std::string type = "hinge";
};

/// One limb; the other side is its mirror image.
struct BuiltLimb {
  std::vector<BuiltJoint> joints;
  Eigen::Vector3d end = Eigen::Vector3d::Zero();  ///< From the last joint to wrist or ankle.
  bool marked = true;                             ///< A body is fixed at the end.
  bool heavy = true;  ///< The last segment's mass lies in its middle; else it has next to none.
  std::string more;   ///< MJCF inside the last body.
};

inline const Eigen::Vector3d kAxisX{1, 0, 0}, kAxisY{0, 1, 0}, kAxisZ{0, 0, 1};

/// Shoulder, elbow and wrist, or hip, knee and ankle, where BuiltHumanoid has them at zero.
struct BuiltPoints {
  Eigen::Vector3d root, middle, end;
};

/// A humanoid whose pelvis is at 1 m, with hips 0.1 m aside and 0.05 m below it, shoulders 0.15 m
/// aside and 0.4 m above it.
struct BuiltHumanoid {
  BuiltLimb leg, arm;
  std::string before;  ///< MJCF before the world.
  std::string after;   ///< And behind it.
  std::string root = "<freejoint/>";
  std::string pelvis = "pos=\"0 0 1\"";

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
    // axes of turns are mirrored with the other sign
    const Eigen::Vector3d axis(sign * joint.axis.x(), joint.axis.y(), sign * joint.axis.z());
    text += fmt::format(
        "<body name=\"{0}_{1}\" pos=\"{2}\"><joint name=\"{0}_{1}\" type=\"{3}\" axis=\"{4}\" "
        "range=\"{5} {6}\"/>",
        side, joint.name, text_of(i == 0 ? mirrored(place + joint.at) : mirrored(joint.at)),
        joint.type, text_of(axis), joint.lower, joint.upper);
    text +=
        last && !limb.heavy ? mass(Eigen::Vector3d::Zero(), 1e-6) : mass(0.5 * mirrored(next), 1);
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
  std::string text = "<mujoco>" + before +
                     "<compiler angle=\"radian\"/><worldbody><body name=\"pelvis\" " + pelvis +
                     ">" + root + mass;
  for (const std::string side : {"left", "right"}) text += limb_text(leg, side, {0, 0.1, -0.05});
  text += "<body name=\"torso\">" + mass;
  for (const std::string side : {"left", "right"}) text += limb_text(arm, side, {0, 0.15, 0.4});
  return text + "</body></body></worldbody>" + after + "</mujoco>";
}

/// Hip of three joints, knee, ankle of two: thigh 0.2 m, shin 0.25 m.
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

/// Shoulder of three joints, elbow, hand: upper arm 0.18 m, forearm 0.15 m, hanging.
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
  return {plain_leg(), plain_arm(), {}, {}};
}

}  // namespace retarget
