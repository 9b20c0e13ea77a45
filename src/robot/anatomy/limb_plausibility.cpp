#include "robot/anatomy/limb_plausibility.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>

#include "retarget/text.h"
#include "robot/model/kinematic_tree.h"

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

int middle_vote_of_names(const Robot& robot, int joint, bool is_leg) {
  using namespace std::string_view_literals;
  constexpr std::array kKnee = {"knee"sv, "calf"sv, "shin"sv, "shank"sv};
  constexpr std::array kElbow = {"elbow"sv, "forearm"sv, "lower_arm"sv, "lowerarm"sv};
  constexpr std::array kOther = {"hip"sv,      "thigh"sv, "ankle"sv, "foot"sv,      "toe"sv,
                                 "shoulder"sv, "wrist"sv, "hand"sv,  "upper_arm"sv, "gripper"sv};
  const std::string name = lower_case(robot.joints()[joint].name + " " +
                                      robot.bodies()[robot.joints()[joint].body].name);
  const bool is_middle = is_leg ? names_one_of(name, kKnee) : names_one_of(name, kElbow);
  if (is_middle) return 1;
  return names_one_of(name, kOther) ? -1 : 0;
}

}  // namespace retarget
