#include "robot/anatomy/limb_notes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kLeaning = 15.0;  // Degrees.
constexpr double kOblique = 0.1;   // Sine of the angle to the axes: 6 degrees.

}  // namespace

void note_limbs(const Robot& robot, const ZeroPose& zero, RobotAnatomy& found) {
  if (zero.lean > kLeaning) {
    found.notes.push_back(
        fmt::format("the trunk leans by {} degrees in the zero configuration, which is assumed to "
                    "be upright: turn the root body, or all motions lean by this angle",
                    number_text(zero.lean, 0)));
  }
  const double aside = std::min(std::abs(found.forward.x()), std::abs(found.forward.y()));
  if (aside > kOblique) {
    found.notes.push_back(
        fmt::format("the robot faces {} {} (x y) in its zero configuration, oblique to the axes",
                    number_text(found.forward.x(), 2), number_text(found.forward.y(), 2)));
  }
  if (!std::ranges::all_of(found.legs, &Limb::flexion_is_sure)) {
    found.notes.emplace_back("the knees' ranges allow both directions: assumed to bend backwards");
  }
  if (!std::ranges::all_of(found.arms, &Limb::flexion_is_sure)) {
    found.notes.emplace_back("the elbows' ranges allow both directions: assumed to bend forwards");
  }
  if (found.arms[0].lower_is_estimated || found.arms[1].lower_is_estimated) {
    found.notes.emplace_back(
        "the ends of the forearms are unmarked: their direction and length are estimated from "
        "their masses");
  }
  if (const auto toe = zero.toe) {
    found.notes.push_back("\"" + robot.joints()[*toe].name +
                          "\" is assumed to be a toe and follows nothing; the foot is " + "\"" +
                          robot.bodies()[found.legs[0].end->body].name + "\"");
  }
  if (found.has_legs && !found.legs[0].end) {
    found.notes.emplace_back("the legs end at the knee's body: there is no ankle joint");
  }
}

void doubt_limbs(const Robot& robot, RobotAnatomy& found) {
  constexpr double kShort = 0.4;
  for (const bool is_leg : {true, false}) {
    for (std::size_t side = 0; side < 2; ++side) {
      const Limb& limb = is_leg ? found.legs[side] : found.arms[side];
      if (limb.joints.empty()) continue;
      const std::string of_side = side == 0 ? "left " : "right ";
      const std::string middle = of_side + (is_leg ? "knee" : "elbow");
      const std::string& joint = robot.joints()[limb.joints[limb.middle]].name;
      if (limb.clarity < kClearMiddle) {
        found.doubts.push_back(fmt::format(
            "the {} is assumed to be \"{}\"; another joint fits nearly as well", middle, joint));
      }
      const bool upper_is_short = limb.upper_length < limb.lower_length;
      const double ratio = upper_is_short ? limb.upper_length / limb.lower_length
                                          : limb.lower_length / limb.upper_length;
      if (ratio >= kShort) continue;
      const std::string upper = of_side + (is_leg ? "thigh" : "upper arm");
      const std::string lower = of_side + (is_leg ? "shin" : "forearm");
      found.doubts.push_back(fmt::format("the {} is {} as long as the {}: is \"{}\" the {}?",
                                         upper_is_short ? upper : lower, number_text(ratio, 2),
                                         upper_is_short ? lower : upper, joint, middle));
    }
  }
}

}  // namespace retarget
