#include "robot/anatomy/limb_flexion.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace retarget {

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
