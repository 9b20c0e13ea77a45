#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "robot/shape_distance.h"
#include "robot/visible_shapes.h"
#include "view/figure.h"

namespace retarget {

/// A sphere, capsule or box of one colour, in the world.
struct Solid {
  RoundedShape shape;
  int colour = 0xFFFFFF;  ///< 0xRRGGBB
};

/// A body in one pose.
using SolidFigure = std::vector<Solid>;

/// @param shapes  visible_shapes of the robot.
/// @param qpos    a configuration of the robot's.
[[nodiscard]] SolidFigure robot_solids(const Robot& robot,
                                       const std::vector<CollisionShape>& shapes,
                                       std::span<const double> qpos);

/// The bones as capsules, left and right in colours of their own, and a head.
[[nodiscard]] SolidFigure human_solids(const HumanClip& human, int frame);

/// Moves a figure.
void shift(SolidFigure& figure, const Eigen::Vector3d& by);

/// The smallest rectangle of the page that holds a figure; metres.
[[nodiscard]] Eigen::AlignedBox2d extent(const SolidFigure& figure, const Camera& camera);

}  // namespace retarget
