#pragma once

#include <Eigen/Core>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"

namespace retarget {

/// Ankles and toes of a body.
[[nodiscard]] std::vector<int> feet_of_body(const Body& body);

/// Other joints that may carry a body.
[[nodiscard]] std::vector<int> supports_of_body(const Body& body);

/// Speed at which the parts that may carry a body slide, legs per second: the median over the clip
/// of the slowest foot, or part that is lower than the feet. Only steady movements count: noise moves
/// a foot back and forth, so that its displacements in two successive times have a negative product.
/// 0: unknown, or no such movement.
/// @param up       unit vector in the file's axes
/// @param measured matrix that is applied to displacements
[[nodiscard]] double steady_slide(const Clip& clip, const Body& body, const Eigen::Vector3d& up,
                                  const Eigen::Matrix3d& measured);

}  // namespace retarget
