#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"

namespace retarget {

/// Motion of ankles and toes in short time steps, spread over a clip. It separates the effect of
/// the root translation, which may be scaled, from the rest. Lengths are in legs.
class FootSteps {
 public:
  /// @param slots  translation slots of the root (Skeleton::translation_slot)
  /// @param up     unit vector in the file's axes. If known, parts of the body that are lower than
  ///               the feet count as feet: they carry the body.
  FootSteps(const Clip& clip, const Body& body, const std::vector<int>& slots,
            const std::optional<Eigen::Vector3d>& up = std::nullopt);

  [[nodiscard]] bool empty() const { return steps_.empty(); }
  /// Mean speed of the slowest ankle or toe with a scaled root translation, legs per second.
  /// @param root_scale  a number or a matrix
  template <typename Scale>
  [[nodiscard]] double slowest_foot(const Scale& root_scale) const {
    double sum = 0.0;
    for (const auto& step : steps_) sum += slowest_in(step, root_scale);
    return steps_.empty() ? 0.0 : sum / static_cast<double>(steps_.size());
  }
  /// Mean speed of the root, legs per second.
  /// @param measured  matrix that is applied to displacements
  [[nodiscard]] double root(const Eigen::Matrix3d& measured = Eigen::Matrix3d::Identity()) const;
  /// Mean cosine between trunk and legs, as seen from the hips: near 1 if they point the same way,
  /// which no body does; 0 if unknown.
  [[nodiscard]] double fold() const { return fold_; }

 private:
  struct FootStep {
    Eigen::Vector3d by_root, by_others;
  };
  template <typename Scale>
  [[nodiscard]] static double slowest_in(const std::vector<FootStep>& step,
                                         const Scale& root_scale) {
    double slowest = std::numeric_limits<double>::infinity();
    for (const FootStep& foot : step) {
      slowest = std::min(slowest, (root_scale * foot.by_root + foot.by_others).norm());
    }
    return slowest;
  }

  std::vector<std::vector<FootStep>> steps_;  // One per time step and foot.
  double fold_ = 0.0;
};

}  // namespace retarget
