#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/limbs.h"
#include "retarget/robot.h"

namespace retarget {

/// Two bodies whose shapes are in each other by the model itself, whatever the robot does.
struct ModelOverlap {
  int a = 0, b = 0;    ///< Bodies, the smaller index first.
  double depth = 0.0;  ///< Metres, the largest in the poses that were given; 0: apart in all.
  double share = 0.0;  ///< Of the sampled configurations: those in which they overlap, 0 to 1.
};

/// Pairs of bodies whose contact would be the model's fault and not a motion's, sorted: those that
/// overlap in nearly all configurations, and those that overlap in one of the given poses. A pair with a
/// forearm or a hand, which can be held anywhere and may hang against a thigh, must also overlap in a good
/// part of all configurations.
///
/// Only pairs that count as self-collision are looked at (CollisionModel). Configurations are
/// those of Richtmyer's sequence over the joints' ranges, always the same ones. As each joint has a
/// sequence of its own, the joints between any two bodies are sampled evenly too.
///
/// @param poses  configurations that the robot must be able to stand in: its rest pose, its T-pose.
[[nodiscard]] std::vector<ModelOverlap> model_overlaps(const Robot& robot,
                                                       const RobotAnatomy& limbs,
                                                       std::span<const std::vector<double>> poses);

/// `"left_thigh" and "right_thigh" overlap by 2.1 cm at rest and in 43 % of poses`
[[nodiscard]] std::string overlap_text(const Robot& robot, const ModelOverlap& overlap);

/// Contacts that are no fault, and why those are that the tree does not explain.
struct AllowedContacts {
  std::vector<std::pair<int, int>> pairs;  ///< neighbours(), the model's own, then overlaps.
  std::vector<ModelOverlap> overlaps;      ///< Of bodies that are none of the first two.
};

/// What a robot may touch itself with when nobody has said it.
/// @param robot     with its shapes; what its profile allows is not looked at.
/// @param excluded  names of bodies whose contact the model itself excludes; unknown ones are left out.
/// @param poses     as of model_overlaps.
[[nodiscard]] AllowedContacts find_allowed_contacts(
    const Robot& robot, const RobotAnatomy& limbs,
    std::span<const std::pair<std::string, std::string>> excluded,
    std::span<const std::vector<double>> poses);

}  // namespace retarget
