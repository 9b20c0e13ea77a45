#pragma once

#include <Eigen/Core>

#include "view/figure.h"
#include "view/image.h"
#include "view/solid.h"

namespace retarget {

/// Part of a picture into which one figure is drawn, in orthographic projection.
struct Frame {
  int left = 0, top = 0, width = 0, height = 0;      ///< Pixels.
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< Pixel of the world's origin.
  double scale = 100.0;                              ///< Pixels per metre.
};

/// Draws a figure over the existing picture: lit from above, with ambient occlusion between its
/// parts and soft shadows on the ground (z = 0). Uses nine samples per pixel, and only sums,
/// products and square roots, so that the result is the same on every machine.
void render(const SolidFigure& figure, const Camera& camera, const Frame& frame, Image& image);

}  // namespace retarget
