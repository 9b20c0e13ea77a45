#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Two bodies whose shapes overlap in the model itself, in every motion.
struct ModelOverlap {
  int a = 0, b = 0;    ///< Body indices, the smaller first.
  double depth = 0.0;  ///< Largest overlap in the given poses, metres; 0 if apart in all of them.
  double share = 0.0;  ///< Fraction of the sampled configurations in which they overlap, 0 to 1.
};

/// Finds body pairs whose contact is a property of the model rather than of a motion, sorted: pairs
/// that overlap in nearly all configurations, and pairs that overlap in one of the given poses. A
/// pair with a forearm or a hand, which can move freely and may rest against a thigh, must also
/// overlap in a significant fraction of all configurations. The mirror image of such a pair is
/// included even if it overlaps less (mirrored_bodies).
///
/// Tests only pairs that count as self-collision (CollisionModel). The samples follow Richtmyer's
/// sequence over the joints' ranges and are always the same. Each joint has its own sequence, so
/// the joints between any two bodies are sampled evenly too.
///
/// @param poses  configurations that the robot must be able to hold: its rest pose, its T-pose.
[[nodiscard]] std::vector<ModelOverlap> model_overlaps(const Robot& robot,
                                                       const RobotAnatomy& limbs,
                                                       std::span<const std::vector<double>> poses);

/// `"left_thigh" and "right_thigh" overlap by 2.1 cm at rest and in 43 % of poses`
[[nodiscard]] std::string overlap_text(const Robot& robot, const ModelOverlap& overlap);

/// Returns texts of pairs as a list, shortened to the first eight of them.
[[nodiscard]] std::string list_overlaps(const std::vector<std::string>& texts);

/// Introduces a list of pairs whose contact is ignored.
inline constexpr const char* kOverlapsIgnored =
    "their shapes overlap in the model, so their contact is ignored: ";

/// Allowed contacts, with the reasons for those that the tree does not explain.
struct AllowedContacts {
  std::vector<std::pair<int, int>> pairs;  ///< neighbours(), then the model's exclusions, then
                                           ///< overlaps.
  std::vector<ModelOverlap> overlaps;  ///< Overlapping pairs that are in neither of the first two
                                       ///< groups.
};

/// Determines the self-contacts to allow for a robot whose profile does not list them.
/// @param robot     provides the shapes; the contacts that its profile allows are ignored.
/// @param excluded  body name pairs that the model excludes from contact; unknown names are
///   ignored.
/// @param poses     see model_overlaps.
[[nodiscard]] AllowedContacts find_allowed_contacts(
    const Robot& robot, const RobotAnatomy& limbs,
    std::span<const std::pair<std::string, std::string>> excluded,
    std::span<const std::vector<double>> poses);

}  // namespace retarget
