#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Ends of a sole, in the library's order of foot parts.
inline constexpr int kSoleHeel = 0, kSoleToe = 1;

/// Points at one end of a sole, in the body's frame, metres.
struct SolePoints {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Mean of the corners.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();     ///< The sole's outermost point at this end.
  double half_width = 0.0;                           ///< Half the width of the corners.
  std::vector<Eigen::Vector3d> points;               ///< Corners and tips.
};

/// Heel and toe of a sole.
struct SoleShape {
  std::array<SolePoints, 2> ends;
  Eigen::Vector3d sideways =
      Eigen::Vector3d::UnitY();  ///< Unit vector perpendicular to the line from heel to toe.
  double body_height = 0.0;      ///< Height of the body's origin above the line from heel to toe.
};

/// Classifies a sole's points as heel or toe: by their labels (`heel_...`, `toe_...`; corners, or
/// tips if they end in `_tip`), otherwise by position: the longest line runs from heel to toe, and
/// the ankle is nearer to the heel. Returns nothing for a sole without both.
[[nodiscard]] std::optional<SoleShape> sole_shape(const Sole& sole);

}  // namespace retarget
