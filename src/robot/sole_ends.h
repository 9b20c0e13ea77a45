#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// The ends of a sole, in the order of the library's feet.
inline constexpr int kSoleHeel = 0, kSoleToe = 1;

/// The points of one end of a sole, in its body's frame, metres.
struct SolePoints {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Of the corners.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();     ///< As far out as the sole reaches, beyond it.
  double half_width = 0.0;                           ///< Of the corners.
  std::vector<Eigen::Vector3d> points;               ///< Corners and tips.
};

/// Heel and toe of a sole.
struct SoleShape {
  std::array<SolePoints, 2> ends;
  Eigen::Vector3d sideways =
      Eigen::Vector3d::UnitY();  ///< Unit, square to the way from heel to toe.
  double body_height = 0.0;      ///< Of the body's origin over the line from heel to toe.
};

/// Which points belong to the heel and which to the toe: by their labels (`heel_...`, `toe_...`, of
/// corners or ending in `_tip`), else by where they lie: the longest line runs from heel to toe, and
/// the ankle stands nearer to the heel. Nothing for a sole without both.
[[nodiscard]] std::optional<SoleShape> sole_shape(const Sole& sole);

}  // namespace retarget
