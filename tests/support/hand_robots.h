#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "retarget/load_robot.h"
#include "support/humanoids.h"
#include "support/test_robots.h"

namespace retarget {

/// The tiny humanoid in a T-pose, palms down, with hands at the ends of its arms.
/// @param hand  returns the MJCF bodies of a hand for its side ("left") and its y sign as text (""
///   for the left side)
/// @param after  MJCF after the world body, such as equalities
template <typename Hand>
std::string humanoid_with_hands(const Hand& hand, const std::string& after = "") {
  std::string text = tiny_humanoid(false);
  for (const std::string side : {"left", "right"}) {
    const std::string open = "<body name=\"" + side + "_hand\"";
    const std::size_t at = text.find("/>", text.find(open)) + 2;  // After its inertial element.
    text.insert(at, hand(side, side == "left" ? "" : "-"));
  }
  const std::size_t end = text.find("</mujoco>");
  text.insert(end, after);
  return text;
}

/// Hands with five fingers and six motors: the thumb turns and bends, each other finger bends, and
/// the outer joints are coupled.
inline std::string six_motor_hands() {
  const auto body = [](const std::string& name, const std::string& pos, const std::string& joint,
                       const std::string& inner) {
    return "<body name=\"" + name + "\" pos=\"" + pos + "\">" +
           "<inertial pos=\"0 0 0\" mass=\"0.01\" diaginertia=\"1e-5 1e-5 1e-5\"/>" + joint +
           inner + "</body>";
  };
  const auto hinge = [](const std::string& name, const std::string& axis,
                        const std::string& range) {
    return "<joint name=\"" + name + "\" axis=\"" + axis + "\" range=\"" + range + "\"/>";
  };
  std::string ties;
  const auto tie = [&](const std::string& name, const std::string& leader, const std::string& by) {
    ties += "<joint joint1=\"" + name + "\" joint2=\"" + leader + "\" polycoef=\"" + by + "\"/>";
  };
  const auto hand = [&](const std::string& side, const std::string& s) {
    // Fingers point along +-y; a positive rotation about `bend` moves them down.
    const std::string bend = s.empty() ? "-1 0 0" : "1 0 0";
    const auto tip = [&](const std::string& along) {
      return "<geom type=\"sphere\" size=\"0.007\" pos=\"" + along + "\"/>";
    };
    std::string all;
    const char* const places[] = {"0.028", "0.009", "-0.009", "-0.028"};
    const char* const names[] = {"index", "middle", "ring", "pinky"};
    for (int i = 0; i < 4; ++i) {
      const std::string name = side + "_" + names[i];
      tie(name + "_intermediate", name + "_proximal", "-0.04 1.1 0 0 0");
      all += body(name + "_1", std::string(places[i]) + " " + s + "0.09 0",
                  hinge(name + "_proximal", bend, "0 1.47"),
                  body(name + "_2", "0 " + s + "0.035 0",
                       hinge(name + "_intermediate", bend, "-0.05 1.6"), tip("0 " + s + "0.04 0")));
    }
    const std::string name = side + "_thumb", flex = s.empty() ? "0 0 1" : "0 0 -1";
    tie(name + "_intermediate", name + "_pitch", "0 1.3 0 0 0");
    tie(name + "_distal", name + "_pitch", "0 0.7 0 0 0");
    const std::string part = "0.028 " + s + "0.02 -0.006";
    all +=
        body(name + "_0", "0.03 " + s + "0.035 -0.012", hinge(name + "_yaw", "0 1 0", "0 1.4"),
             body(name + "_1", "0.008 " + s + "0.004 0", hinge(name + "_pitch", flex, "-0.2 0.7"),
                  body(name + "_2", part, hinge(name + "_intermediate", flex, "-0.3 1.0"),
                       body(name + "_3", "0.02 " + s + "0.014 -0.004",
                            hinge(name + "_distal", flex, "-0.2 0.6"),
                            tip("0.016 " + s + "0.011 -0.003")))));
    return all;
  };
  const std::string text = humanoid_with_hands(hand);
  std::string with_ties = text;
  with_ties.insert(text.find("</mujoco>"), "<equality>" + ties + "</equality>");
  return with_ties;
}

/// Grippers with two coupled jaws, front and back, that slide towards each other.
inline std::string grippers() {
  std::string ties;
  const auto hand = [&](const std::string& side, const std::string& s) {
    std::string all;
    for (const std::string jaw : {"front", "back"}) {
      const std::string x = jaw == "front" ? "" : "-", inwards = jaw == "front" ? "-1" : "1";
      all += "<body name=\"" + side + "_jaw_" + jaw + "\" pos=\"" + x + "0.05 " + s + "0.08 0\">" +
             "<inertial pos=\"0 0 0\" mass=\"0.01\" diaginertia=\"1e-5 1e-5 1e-5\"/>" +
             "<joint name=\"" + side + "_" + jaw + "\" type=\"slide\" axis=\"" + inwards +
             " 0 0\" range=\"0 0.045\"/><geom type=\"box\" size=\"0.005 0.03 0.005\" pos=\"0 " + s +
             "0.03 0\"/></body>";
    }
    ties += "<joint joint1=\"" + side + "_back\" joint2=\"" + side +
            "_front\" polycoef=\"0 1 0 0 0\"/>";
    return all;
  };
  std::string text = humanoid_with_hands(hand);
  return text.insert(text.find("</mujoco>"), "<equality>" + ties + "</equality>");
}

/// Loads a robot of the repository by name.
inline std::shared_ptr<const Robot> load_shipped_robot(const std::string& name) {
  const auto folder = std::filesystem::path(RETARGET_SOURCE_DIR) / "robots" / name;
  const auto robot =
      load_robot_files((folder / "model.xml").string(), (folder / "robot.json").string());
  EXPECT_TRUE(robot.has_value()) << (robot ? "" : describe(robot.error()));
  return robot ? *robot : nullptr;
}

}  // namespace retarget
