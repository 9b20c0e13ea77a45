#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "robot/anatomy/limb_shape.h"

namespace retarget {
namespace {

// Returns the fraction of the limb's mass carried by the joint; fingers count as part of their
// hand.
double share_beyond(const Robot& robot, const MiddleJoint& middle) {
  const auto mass_from = [&](int index) {
    return robot.model()->body_subtreemass[robot.joints()[middle.chain[index]].body];
  };
  const double whole = mass_from(0);
  return whole > 0.0 ? mass_from(middle.index) / whole : 0.5;
}

bool names_one_of(const std::string& name, std::span<const std::string_view> words) {
  return std::ranges::any_of(
      words, [&](std::string_view word) { return name.find(word) != std::string::npos; });
}

}  // namespace

double plausibility(const Robot& robot, const MiddleJoint& middle) {
  constexpr double kSingleJoint = 0.5;
  constexpr double kHardlyTurns = 0.6;
  constexpr double kLeastRange = 0.7;  // Radians.
  constexpr double kOddMass = 0.8;
  constexpr double kLeastBeyond = 0.02, kMostBeyond = 0.9;
  double factor = 1.0;
  if (middle.before < 2) factor *= kSingleJoint;
  const int joint = middle.chain[middle.index];
  const LimitSet& limits = robot.model_limits();
  if (limits.upper[joint] - limits.lower[joint] < kLeastRange) factor *= kHardlyTurns;
  const double beyond = share_beyond(robot, middle);
  if (beyond < kLeastBeyond || beyond > kMostBeyond) factor *= kOddMass;
  return factor;
}

int middle_vote_of_name(const std::string& any_case, bool is_leg) {
  using namespace std::string_view_literals;
  constexpr std::array kKnee = {"knee"sv, "calf"sv, "shin"sv, "shank"sv};
  constexpr std::array kElbow = {"elbow"sv, "forearm"sv, "lower_arm"sv, "lowerarm"sv};
  constexpr std::array kOther = {"hip"sv,      "thigh"sv, "ankle"sv, "foot"sv,      "toe"sv,
                                 "shoulder"sv, "wrist"sv, "hand"sv,  "upper_arm"sv, "gripper"sv};
  const std::string name = lower_case(any_case);
  const bool is_middle = is_leg ? names_one_of(name, kKnee) : names_one_of(name, kElbow);
  if (is_middle) return 1;
  return names_one_of(name, kOther) ? -1 : 0;
}

int middle_vote_of_names(const Robot& robot, int joint, bool is_leg) {
  const RobotJoint& of = robot.joints()[joint];
  return middle_vote_of_name(of.name + " " + robot.bodies()[of.body].name, is_leg);
}

LimbNames limb_named_by(const Robot& robot, int joint) {
  using namespace std::string_view_literals;
  constexpr std::array kLeg = {"hip"sv,   "thigh"sv, "knee"sv, "calf"sv, "shin"sv,
                               "shank"sv, "ankle"sv, "foot"sv, "leg"sv};
  constexpr std::array kArm = {"shoulder"sv, "arm"sv, "elbow"sv, "wrist"sv, "hand"sv, "gripper"sv};
  const std::string name = lower_case(robot.joints()[joint].name + " " +
                                      robot.bodies()[robot.joints()[joint].body].name);
  return {names_one_of(name, kLeg), names_one_of(name, kArm)};
}

namespace {

constexpr double kLeaning = 15.0;  // Degrees.
constexpr double kTilted = 0.5;    // Degrees.
constexpr double kOblique = 0.1;   // Sine of the angle to the axes: 6 degrees.

}  // namespace

void note_limbs(const Robot& robot, const ZeroPose& zero, RobotAnatomy& found) {
  if (zero.lean > kLeaning) {
    found.notes.push_back(
        fmt::format("the trunk leans by {} degrees in the zero configuration, which is assumed to "
                    "be upright: turn the root body, or all motions lean by this angle",
                    number_text(zero.lean, 0)));
  }
  if (zero.foot_tilt > kTilted) {
    found.notes.push_back(
        fmt::format("the feet are {} degrees off level in the zero configuration: the flat "
                    "undersides of their contact geoms are taken as the soles",
                    number_text(zero.foot_tilt, 0)));
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
                          "\" is assumed to be a toe and does not follow the human; the foot is " +
                          "\"" + robot.bodies()[found.legs[0].end->body].name + "\"");
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

void doubt_sides(RobotAnatomy& found) {
  constexpr double kUnequal = 0.03;  // Fraction of the longer segment.
  std::vector<std::string> unequal;
  const auto compare = [&](const std::string& segment, double left, double right) {
    if (std::abs(left - right) <= kUnequal * std::max(left, right)) return;
    unequal.push_back(
        fmt::format("{} {} and {} m", segment, number_text(left, 3), number_text(right, 3)));
  };
  if (found.has_legs) {
    compare("thighs", found.legs[0].upper_length, found.legs[1].upper_length);
    compare("shins", found.legs[0].lower_length, found.legs[1].lower_length);
  }
  compare("upper arms", found.arms[0].upper_length, found.arms[1].upper_length);
  compare("forearms", found.arms[0].lower_length, found.arms[1].lower_length);
  if (unequal.empty()) return;
  found.doubts.push_back("limbs of left and right differ in length: " +
                         list_names(unequal, unequal.size()));
}

}  // namespace retarget
