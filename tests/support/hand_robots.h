#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "retarget/load_robot.h"
#include "support/humanoids.h"
#include "support/test_robots.h"
#include "support/value_of.h"

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

/// Hands like the LEAP hand: three equal fingers and a thumb, of four joints each. A finger bends,
/// turns sideways, and bends twice more. Only the thumb has a name.
/// @param thumb_is_named  false: the thumb has no name either.
inline std::string leap_like_hands(bool thumb_is_named = true) {
  const auto hand = [&](const std::string& side, const std::string& s) {
    const std::string bend = s.empty() ? "-1 0 0" : "1 0 0", aside = "0 0 1";
    int number = 0;
    const auto link = [&](const std::string& name, const std::string& pos, const std::string& axis,
                          const std::string& range, const std::string& inner) {
      return "<body name=\"" + side + "_" + name + "\" pos=\"" + pos +
             "\"><inertial pos=\"0 0 0\" mass=\"0.03\" diaginertia=\"1e-5 1e-5 1e-5\"/><joint "
             "name=\"" +
             side + "_j" + std::to_string(number++) + "\" axis=\"" + axis + "\" range=\"" + range +
             "\"/>" + inner + "</body>";
    };
    const auto tip = [](const std::string& at) {
      return "<geom type=\"sphere\" size=\"0.01\" pos=\"" + at + "\"/>";
    };
    std::string all;
    const char* const places[] = {"0.045", "0", "-0.045"};
    for (int i = 0; i < 3; ++i) {
      const std::string n = std::to_string(i + 1);
      all += link("mcp_" + n, std::string(places[i]) + " " + s + "0.07 -0.01", bend, "-0.31 2.23",
                  link("pip_" + n, "0 " + s + "0.015 0.014", aside, "-1.05 1.05",
                       link("dip_" + n, "0 " + s + "0.036 -0.014", bend, "-0.5 1.88",
                            link("fingertip_" + n, "0 " + s + "0.036 0", bend, "-0.36 2.04",
                                 tip("0 " + s + "0.04 0")))));
    }
    // The thumb begins below the palm and points forwards.
    const std::string flex = s.empty() ? "0 0 1" : "0 0 -1";
    const std::string name = thumb_is_named ? "thumb_" : "branch_";
    all += link(name + "base", "0.04 " + s + "0.02 -0.02", "0 1 0", "-0.35 2.09",
                link(name + "pip", "0.015 0 0", flex, "-0.47 2.44",
                     link(name + "dip", "0.035 " + s + "0.01 0", flex, "-1.2 1.9",
                          link(name + "fingertip", "0.045 " + s + "0.01 0", flex, "-1.34 1.88",
                               tip("0.035 " + s + "0.01 0")))));
    return all;
  };
  return humanoid_with_hands(hand);
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

}  // namespace retarget
