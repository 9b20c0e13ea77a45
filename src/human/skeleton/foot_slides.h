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

/// Displacements of the parts that may carry a body: of its feet, and of parts that are lower.
class FootSlides {
 public:
  /// @param up  unit vector in the file's axes
  FootSlides(const Clip& clip, const Body& body, const Eigen::Vector3d& up);

  /// Speed at which these parts slide, legs per second: the median over the clip of the slowest one.
  /// Only steady movements count: noise moves a foot back and forth, so that its displacements in
  /// two successive times have a negative product. 0: unknown, or no such movement.
  /// @param measured  matrix that is applied to displacements
  [[nodiscard]] double steady(const Eigen::Matrix3d& measured) const;

 private:
  // Displacements of a part in two successive times.
  struct Slide {
    Eigen::Vector3d before, after;
  };

  std::vector<std::vector<Slide>> samples_;  // By sample, one slide per part.
  double unit_ = 0.0;                        // Displacement that is one leg per second.
};

}  // namespace retarget
