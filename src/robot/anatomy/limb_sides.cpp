#include "robot/anatomy/limb_sides.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "retarget/text.h"

namespace retarget {
namespace {

// Returns +1 if the names mark the first as the left one, -1 for the second, 0 if unclear.
int side_by_names(const std::string& first, const std::string& second) {
  std::size_t same = 0;
  while (same < std::min(first.size(), second.size()) && first[same] == second[same]) ++same;
  if (same == first.size() || same == second.size()) return 0;
  const auto letter = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  const int a = letter(first[same]);
  const int b = letter(second[same]);
  if (a == 'l' && b == 'r') return 1;
  return a == 'r' && b == 'l' ? -1 : 0;
}

}  // namespace

Result<void> check_joint_counts(const Robot& robot, const std::string& file,
                                const std::array<LimbShape, 2>& limbs) {
  const auto &a = limbs[0].joints, &b = limbs[1].joints;
  if (a.size() == b.size()) return {};
  const auto name_of = [&](const std::vector<int>& joints) {
    return joints.empty() ? std::string("none") : printable(robot.joints()[joints.front()].name);
  };
  return config_failure(file,
                        fmt::format("the limbs starting at {} and {} end at different joints: {} "
                                    "and {} joints",
                                    name_of(a), name_of(b), a.size(), b.size()),
                        "place the joints of both sides symmetrically");
}

int side_by_names(const Robot& robot, const std::array<LimbShape, 2>& limbs) {
  int votes = 0;
  for (std::size_t i = 0; i < limbs[0].joints.size(); ++i) {
    const RobotJoint& a = robot.joints()[limbs[0].joints[i]];
    const RobotJoint& b = robot.joints()[limbs[1].joints[i]];
    votes += side_by_names(a.name, b.name);
    votes += side_by_names(robot.bodies()[a.body].name, robot.bodies()[b.body].name);
  }
  return votes;
}

Result<void> compare_flexion(const Robot& robot, const std::string& file, bool is_leg,
                             std::array<LimbShape, 2>& limbs, RobotAnatomy& found) {
  constexpr double kMirrored = 0.5;  // Cosine.
  constexpr double kRoom = 0.7;      // Radians.
  const auto motion = [&](const LimbShape& limb) -> Eigen::Vector3d {
    return limb.axis.cross(limb.end - limb.bend).normalized();
  };
  const Eigen::Vector3d first = motion(limbs[0]);
  const Eigen::Vector3d second =
      motion(limbs[1]) - 2.0 * motion(limbs[1]).dot(found.left) * found.left;
  // +1: the same sign bends both limbs to mirrored sides.
  const double alike = first.dot(second);
  if (std::abs(alike) < kMirrored) return {};
  const double sign = alike > 0.0 ? 1.0 : -1.0;
  if (limbs[0].flexion == 0.0 || limbs[1].flexion == 0.0) {
    const double known = limbs[0].flexion + sign * limbs[1].flexion;
    limbs[0].flexion = known;
    limbs[1].flexion = sign * known;
    return {};
  }
  if (limbs[0].flexion == sign * limbs[1].flexion) return {};
  const bool has_room = std::ranges::all_of(limbs, [&](const LimbShape& limb) {
    const int joint = limb.joints[limb.middle];
    const double lower = robot.model_limits().lower[joint] - limb.straight;
    const double upper = robot.model_limits().upper[joint] - limb.straight;
    return (limb.flexion > 0.0 ? -lower : upper) > kRoom;
  });
  if (has_room) {
    const Eigen::Vector3d way = is_leg ? Eigen::Vector3d(-found.forward)
                                       : Eigen::Vector3d(found.forward - 0.5 * found.left);
    limbs[0].flexion = first.dot(way) > 0.0 ? 1.0 : -1.0;
    limbs[1].flexion = sign * limbs[0].flexion;
    found.notes.push_back(fmt::format(
        "the ranges of the {0} have opposite bending directions: assumed that both bend {1}",
        is_leg ? "knees" : "elbows", is_leg ? "backwards" : "forwards or inwards"));
    return {};
  }
  const auto name = [&](const LimbShape& limb) {
    return "\"" + robot.joints()[limb.joints[limb.middle]].name + "\"";
  };
  return config_failure(
      file,
      fmt::format(
          "the {} bend in opposite directions: the ranges of {} and {} are not mirror images",
          is_leg ? "knees" : "elbows", name(limbs[0]), name(limbs[1])),
      "negate the axis or the range of one of them");
}

}  // namespace retarget
