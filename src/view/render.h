#pragma once

#include <Eigen/Core>

#include "view/figure.h"
#include "view/image.h"
#include "view/solid.h"

namespace retarget {

/// A part of a picture that one figure is drawn into, without perspective.
struct Frame {
  int left = 0, top = 0, width = 0, height = 0;      ///< Pixels.
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< Pixel of the world's origin.
  double scale = 100.0;                              ///< Pixels a metre.
};

/// Draws a figure over what is there: lit from above, its parts darkening each other and, softly, the
/// ground (z = 0) below it. Nine samples a pixel; sums, products and square roots alone, so that
/// every machine draws the same.
void render(const SolidFigure& figure, const Camera& camera, const Frame& frame, Image& image);

}  // namespace retarget
