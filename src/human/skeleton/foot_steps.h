#pragma once

#include <Eigen/Core>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"

namespace retarget {

/// Motion of ankles and toes in short time steps, spread over a clip. It separates the effect of
/// the root translation, which may be scaled, from the rest. Lengths are in legs.
class FootSteps {
 public:
  /// @param slots  translation slots of the root (Skeleton::translation_slot)
  FootSteps(const Clip& clip, const Body& body, const std::vector<int>& slots);

  [[nodiscard]] bool empty() const { return steps_.empty(); }
  /// Mean speed of the slowest ankle or toe with a scaled root translation, legs per second.
  [[nodiscard]] double slowest_foot(double root_scale) const;
  /// Mean speed of the root, legs per second.
  [[nodiscard]] double root() const;
  /// Mean cosine between trunk and legs, as seen from the hips: near 1 if they point the same way,
  /// which no body does; 0 if unknown.
  [[nodiscard]] double fold() const { return fold_; }

 private:
  struct FootStep {
    Eigen::Vector3d by_root, by_others;
  };
  std::vector<std::vector<FootStep>> steps_;  // By time step and foot.
  double fold_ = 0.0;
};

/// Translation slots of the joints from the root to the hips.
[[nodiscard]] std::vector<int> root_slots(const Skeleton& skeleton, const Body& body);

}  // namespace retarget
