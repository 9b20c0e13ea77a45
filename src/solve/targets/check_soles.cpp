#include "solve/targets/check_soles.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>

#include "retarget/kinematic_tree.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// A point of a sole that is farther from its ankle than this fraction of the leg's length is wrong.
// In the included robots, the fraction is at most 0.45.
constexpr double kFarthestPoint = 0.75;
constexpr std::array<const char*, 2> kSoleSides = {"left", "right"};

bool is_in_leg(const Robot& robot, const Limb& leg, int body) {
  const int first = robot.joints()[leg.joints.front()].body;
  while (body > 0 && body != first) body = robot.bodies()[body].parent;
  return body == first;
}

// The largest distance of a sole's points from the ankle, metres.
double distance_from_ankle(const Robot& robot, const Limb& leg, const Sole& sole) {
  const TreeState posed(robot.tree(), reference_configuration(robot));
  const Eigen::Vector3d ankle = posed.world_from_body(leg.end->body) * leg.end->joint;
  double farthest = 0.0;
  for (const Eigen::Vector3d& point : sole.points) {
    const Eigen::Vector3d place = posed.world_from_body(sole.body) * point;
    farthest = std::max(farthest, (place - ankle).norm());
  }
  return farthest;
}

// Describes why a sole is not at the foot of its side; empty if it is.
std::string place_fault(const Robot& robot, const RobotAnatomy& anatomy, const Sole& sole) {
  const std::size_t side = sole.side == kSoleSides[0] ? 0 : 1;
  const std::string& body = robot.bodies()[sole.body].name;
  const bool on_other_leg = is_in_leg(robot, anatomy.legs[1 - side], sole.body);
  // If the facing direction is uncertain, so are the sides of the legs.
  if (on_other_leg && !anatomy.facing_is_sure) return {};
  if (on_other_leg || !is_in_leg(robot, anatomy.legs[side], sole.body)) {
    return fmt::format(
        "the {0} sole is on \"{1}\", which is {2}: name a body of the {0} foot "
        "(\"soles\" in robot.json)",
        sole.side, body,
        on_other_leg ? std::string("in the ") + kSoleSides[1 - side] + " leg" : "not in a leg");
  }
  const Limb& leg = anatomy.legs[side];
  if (!leg.end) return {};
  const double length = leg.upper_length + leg.lower_length;
  const double farthest = distance_from_ankle(robot, leg, sole);
  if (farthest <= kFarthestPoint * length) return {};
  return fmt::format(
      "points of the {} sole are up to {} m from the ankle, and the leg is {} m "
      "long: give them in metres, in the frame of \"{}\" (\"soles\" in robot.json)",
      sole.side, number_text(farthest, 2), number_text(length, 2), body);
}

}  // namespace

SoleFaults check_soles(const Robot& robot, const RobotAnatomy& anatomy) {
  SoleFaults faults;
  const std::vector<Sole>& soles = robot.profile().soles;
  if (soles.size() == 1) {
    faults.missing =
        "only the " + soles.front().side + " foot has a sole (\"soles\" in robot.json)";
  }
  for (const Sole& sole : soles) {
    std::string fault = place_fault(robot, anatomy, sole);
    if (!fault.empty()) faults.misplaced.push_back(std::move(fault));
  }
  return faults;
}

std::string missing_sole_hint(const Robot& robot) {
  const std::size_t given = robot.profile().soles.front().side == kSoleSides[0] ? 0 : 1;
  return std::string("add \"") + kSoleSides[1 - given] +
         "\", or remove \"soles\": runs then derive both from the model";
}

}  // namespace retarget
