#pragma once

#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

namespace retarget {

/// A link of a robot description: the pose of its joint, and the axis of that joint.
struct MakerLink {
  std::string name, parent, pos, quat;
  std::string joint, axis;  ///< Empty: fixed.
};

/// Trees of Unitree Robotics' G1, from the values of its descriptions (BSD-3-Clause): bodies,
/// positions and axes. `23` is g1_23dof_rev_1_0, `27` g1_29dof_lock_waist_rev_1_0, where waist roll
/// and pitch are fixed.
inline std::vector<MakerLink> g1_maker_links(int joints) {
  const std::string x = "1 0 0", y = "0 1 0", z = "0 0 1", straight = "1 0 0 0";
  std::vector<MakerLink> links = {{"pelvis", "", "0 0 0.793", straight, "", ""}};
  const auto add = [&](const std::string& name, const std::string& parent, const std::string& pos,
                       const std::string& quat, const std::string& joint, const std::string& axis) {
    links.push_back({name, parent, pos, quat, joint, axis});
  };
  for (const std::string side : {"left", "right"}) {
    const std::string s = side == "left" ? "" : "-", t = side == "left" ? "-" : "";
    const std::string of = side + "_";
    const auto leg = [&](const std::string& name, const std::string& parent, const std::string& pos,
                         const std::string& quat, const std::string& axis) {
      add(of + name + "_link", parent == "pelvis" ? parent : of + parent + "_link", pos, quat,
          of + name + "_joint", axis);
    };
    leg("hip_pitch", "pelvis", "0 " + s + "0.064452 -0.1027", straight, y);
    leg("hip_roll", "hip_pitch", "0 " + s + "0.052 -0.030465", "0.996179 0 -0.0873386 0", x);
    leg("hip_yaw", "hip_roll", "0.025001 0 -0.12412", straight, z);
    leg("knee", "hip_yaw", "-0.078273 " + s + "0.0021489 -0.17734", "0.996179 0 0.0873386 0", y);
    leg("ankle_pitch", "knee", "0 " + t + "9.4445e-05 -0.30001", straight, y);
    leg("ankle_roll", "ankle_pitch", "0 0 -0.017558", straight, x);
  }
  if (joints == 23) {
    add("torso_link", "pelvis", "-0.0039635 0 0.044", straight, "waist_yaw_joint", z);
  } else {
    add("waist_yaw_link", "pelvis", "0 0 0", straight, "waist_yaw_joint", z);
    add("waist_roll_link", "waist_yaw_link", "-0.0039635 0 0.044", straight, "", "");
    add("torso_link", "waist_roll_link", "0 0 0", straight, "", "");
  }
  for (const std::string side : {"left", "right"}) {
    const std::string s = side == "left" ? "" : "-", t = side == "left" ? "-" : "";
    const std::string of = side + "_";
    const std::string width = side == "left" ? "0.10022" : "-0.10021";
    const auto arm = [&](const std::string& name, const std::string& parent, const std::string& pos,
                         const std::string& quat, const std::string& axis) {
      add(of + name + "_link", parent == "torso" ? "torso_link" : of + parent + "_link", pos, quat,
          of + name + "_joint", axis);
    };
    arm("shoulder_pitch", "torso", "0.0039563 " + width + " 0.24778",
        "0.990264 " + s + "0.139201 1.38722e-05 " + t + "9.86868e-05", y);
    arm("shoulder_roll", "shoulder_pitch", "0 " + s + "0.038 -0.013831",
        "0.990268 " + t + "0.139172 0 0", x);
    arm("shoulder_yaw", "shoulder_roll", "0 " + s + "0.00624 -0.1032", straight, z);
    arm("elbow", "shoulder_yaw", "0.015783 0 -0.080518", straight, y);
    arm("wrist_roll", "elbow", "0.1 " + s + "0.00188791 -0.01", straight, x);
    if (joints == 23) {
      links.back().name = of + "wrist_roll_rubber_hand";
    } else {
      arm("wrist_pitch", "wrist_roll", "0.038 0 0", straight, y);
      arm("wrist_yaw", "wrist_pitch", "0.046 0 0", straight, z);
    }
  }
  return links;
}

/// The same as MJCF, bodies in the order of the list.
inline std::string g1_maker_model(int joints) {
  const std::vector<MakerLink> links = g1_maker_links(joints);
  std::map<std::string, std::string> inside;
  // In reverse order, so that each is complete when its parent includes it.
  for (auto link = links.rbegin(); link != links.rend(); ++link) {
    const std::string joint = link->parent.empty()  ? "<freejoint/>"
                              : link->joint.empty() ? ""
                                                    : fmt::format(R"(<joint name="{}" axis="{}"/>)",
                                                                  link->joint, link->axis);
    std::string& of_parent = inside[link->parent];
    of_parent =
        fmt::format(R"(<body name="{}" pos="{}" quat="{}">{}<geom size="0.01" mass="1"/>{}</body>)",
                    link->name, link->pos, link->quat, joint, inside[link->name]) +
        of_parent;
  }
  return R"(<mujoco><compiler angle="radian"/><worldbody>)" + inside[""] + "</worldbody></mujoco>";
}

}  // namespace retarget
