#pragma once

#include <Eigen/Core>
#include <vector>

#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// The low-passed path of the root's target. The smoothness term penalises only the deviation of
/// the root's acceleration from that of this path. A term on the acceleration itself would flatten
/// the vertical oscillation of the human's hips; the deviation preserves it and still removes
/// tremor.
///
/// The target is that of the root link. If the root has no target, as on robots whose root is the
/// torso, it is that of the hips.
///
/// The cutoff is lower for the horizontal path than for the vertical one, because hips oscillate
/// vertically once per step and laterally once per two steps.
class RootReference {
 public:
  RootReference(const FitModel& model, double frame_time);

  /// False if neither the root nor the hips have a target.
  [[nodiscard]] bool exists() const { return task_ >= 0; }

  /// Displacement of the filtered target from `frame` to the next frame, world, metres. The
  /// displacements are mirrored at the ends of the clip, so that a constant velocity stays
  /// constant.
  /// @pre exists() and frame + 1 < clip.frame_count
  [[nodiscard]] Eigen::Vector3d step(const FitClip& clip, int frame) const;

 private:
  int task_ = -1, tasks_ = 0;
  std::vector<double> horizontal_, vertical_;  // Symmetric taps with sum 1.
};

}  // namespace retarget
