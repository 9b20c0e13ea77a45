#pragma once

#include <algorithm>
#include <string>

#include "support/test_robots.h"

namespace retarget {

/// A simple humanoid, one metre tall. Arms and legs are symmetric, and all bodies have identity
/// orientation at zero.
/// @param arms_down  whether the arms hang in the zero pose; otherwise it is a T-pose
inline std::string tiny_humanoid(bool arms_down) {
  const auto joint = [](const std::string& name, const std::string& axis,
                        const std::string& range) {
    return "<joint name=\"" + name + "\" axis=\"" + axis + "\" range=\"" + range + "\"/>";
  };
  const std::string mass = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
  std::string text =
      "<mujoco><compiler angle=\"radian\"/><worldbody>"
      "<body name=\"pelvis\" pos=\"0 0 0.55\"><freejoint/>" +
      mass;
  for (const std::string side : {"left", "right"}) {
    const bool is_left = side == "left";
    const std::string y = is_left ? "0.1" : "-0.1";
    text += "<body name=\"" + side + "_hip_pitch\" pos=\"0 " + y + " -0.05\">" + mass +
            joint(side + "_hip_pitch", "0 1 0", "-2 2");
    text += "<body name=\"" + side + "_hip_roll\">" + mass +
            joint(side + "_hip_roll", "1 0 0", is_left ? "-0.5 1" : "-1 0.5");
    text += "<body name=\"" + side + "_thigh\">" + mass + joint(side + "_hip_yaw", "0 0 1", "-1 1");
    text += "<body name=\"" + side + "_shin\" pos=\"0 0 -0.2\">" + mass +
            joint(side + "_knee", "0 1 0", "0 2.4");
    text += "<body name=\"" + side + "_ankle\" pos=\"0 0 -0.25\">" + mass +
            joint(side + "_ankle_pitch", "0 1 0", "-1 0.8");
    text += "<body name=\"" + side + "_foot\">" + mass +
            joint(side + "_ankle_roll", "1 0 0", "-0.4 0.4") +
            "<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
    text += "</body></body></body></body></body></body>";
  }
  text += "<body name=\"torso\" pos=\"0 0 0.05\">" + mass + joint("waist", "0 0 1", "-1 1");
  for (const std::string side : {"left", "right"}) {
    const bool is_left = side == "left";
    const std::string sign = is_left ? "" : "-";
    const auto along = [&](const std::string& length) {
      return arms_down ? "0 0 -" + length : "0 " + sign + length + " 0";
    };
    const std::string roll =
        arms_down ? (is_left ? "-0.3 2.5" : "-2.5 0.3") : (is_left ? "-1.8 1.2" : "-1.2 1.8");
    // The elbow bends the forearm forwards: about -y for a hanging arm, about -z (left) or +z
    // (right) for a raised one.
    const std::string bend = arms_down ? "0 -1 0" : "0 0 " + std::string(is_left ? "-1" : "1");
    text += "<body name=\"" + side + "_shoulder_pitch\" pos=\"0 " + sign + "0.15 0.3\">" + mass +
            joint(side + "_shoulder_pitch", "0 1 0", "-3 3");
    text += "<body name=\"" + side + "_shoulder_roll\">" + mass +
            joint(side + "_shoulder_roll", "1 0 0", roll);
    text += "<body name=\"" + side + "_upper_arm\">" + mass +
            joint(side + "_shoulder_yaw", arms_down ? "0 0 1" : "0 1 0", "-2 2");
    text += "<body name=\"" + side + "_forearm\" pos=\"" + along("0.18") + "\">" + mass +
            joint(side + "_elbow", bend, "0 2.2");
    text += "<body name=\"" + side + "_hand\" pos=\"" + along("0.15") + "\">" + mass;
    text += "</body></body></body></body></body>";
  }
  return text + "</body></body></worldbody></mujoco>";
}

/// Replaces every `name="..."` of a body or joint by a meaningless number.
inline std::string scramble_names(const std::string& text) {
  std::string scrambled;
  const std::string key = "name=\"";
  std::size_t at = 0;
  int number = 0;
  for (std::size_t found = text.find(key); found != std::string::npos; found = text.find(key, at)) {
    scrambled += text.substr(at, found - at) + key + "b" + std::to_string(++number * 37 % 101);
    at = text.find('"', found + key.size());
  }
  return scrambled + text.substr(at);
}

}  // namespace retarget
