#pragma once

#include <Eigen/Core>

#include "refine/fit_model.h"

namespace retarget {

/// How far two rounded shapes are apart.
struct FitDistance {
  double distance = 0.0;       ///< Metres; negative: they overlap by as much.
  Eigen::Vector3d normal;      ///< Unit, in the world; a moved along it moves away from b.
  Eigen::Vector3d on_a, on_b;  ///< Nearest points of the shapes' cores, in the world.
};

/// Distance of two shapes in the world; each with the frame of its link.
///
/// Lines by their closed form (Ericson, "Real-Time Collision Detection", section 5.1.9), rectangles
/// and boxes by projecting back and forth; where the cores meet, by the least way that parts them.
[[nodiscard]] FitDistance fit_distance(const RoundedShape& a, const Pose& world_from_a,
                                       const RoundedShape& b, const Pose& world_from_b);

}  // namespace retarget
