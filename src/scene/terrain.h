#pragma once

#include <Eigen/Core>

#include "retarget/scene.h"

namespace retarget {

/// Stairs or a slope that rise in one direction from a straight edge; before it the ground is the
/// floor z = 0. World: metres, Z up.
struct Terrain {
  Eigen::Vector2d edge = Eigen::Vector2d::Zero();    ///< A point of the edge.
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();  ///< Unit vector; the ground rises this way.
  double rise = 0.0, tread = 0.0;  ///< Height and depth of a step, metres; 0: a slope.
  int count = 0;                   ///< Number of steps.
  double slope = 0.0;              ///< Angle, radians.

  [[nodiscard]] bool is_slope() const { return tread == 0.0; }
  /// Distance of a point behind the edge, metres.
  [[nodiscard]] double distance(const Eigen::Vector2d& point) const {
    return along.dot(point - edge);
  }
  /// The step at a distance behind the edge: 0 the floor, `count` the landing at the top.
  [[nodiscard]] int step_at(double distance) const;
  /// Height of the ground at a distance behind the edge, metres.
  [[nodiscard]] double height_at(double distance) const;
};

/// A scene of one static body, `stairs` or `slope`.
/// @param length  length from the edge to the end of the landing or slope, metres
/// @param width   width across, metres
[[nodiscard]] Scene terrain_scene(const Terrain& terrain, double length, double width);

}  // namespace retarget
