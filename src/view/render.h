#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "retarget/appearance.h"
#include "retarget/shape_distance.h"
#include "view/figure.h"
#include "view/image.h"

namespace retarget {

/// A sphere, capsule or box of one colour, in the world frame.
struct Solid {
  RoundedShape shape;
  int colour = 0xFFFFFF;  ///< 0xRRGGBB.
};

/// A body in one pose.
using SolidFigure = std::vector<Solid>;

/// Returns the shapes of a robot in a pose.
/// @param shapes  visible_shapes of the robot.
/// @param qpos    a configuration of the robot.
[[nodiscard]] SolidFigure robot_solids(const Robot& robot,
                                       const std::vector<CollisionShape>& shapes,
                                       std::span<const double> qpos);

/// Returns the bones as capsules with separate colours for left and right, and a head.
[[nodiscard]] SolidFigure human_solids(const HumanClip& human, int frame);

/// Translates a figure.
void shift(SolidFigure& figure, const Eigen::Vector3d& by);

/// Returns the bounding box of a figure on the page, metres.
[[nodiscard]] Eigen::AlignedBox2d extent(const SolidFigure& figure, const Camera& camera);

/// Region of an image into which one figure is rendered, in orthographic projection.
struct Frame {
  int left = 0, top = 0, width = 0, height = 0;      ///< Pixels.
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< Pixel of the world's origin.
  double scale = 100.0;                              ///< Pixels per metre.
};

/// Renders a figure over the existing image: lit from above, with ambient occlusion between its
/// parts and soft shadows on the ground (z = 0). Uses nine samples per pixel, and only sums,
/// products and square roots, so that the result is the same on every machine.
void render(const SolidFigure& figure, const Camera& camera, const Frame& frame, Image& image);

}  // namespace retarget
