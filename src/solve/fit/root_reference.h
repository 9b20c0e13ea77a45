#pragma once

#include <Eigen/Core>
#include <vector>

#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// The accelerations that the root may have without cost: those of its low-passed target. A
/// smoothness term on accelerations alone flattens the bounce of the human's hips; one on the
/// difference to these accelerations keeps it and still removes tremor.
///
/// The target is that of the root link or, if the root has none, that of the hips: the root of some
/// robots is the torso.
///
/// The horizontal target has a lower cutoff than the vertical one: hips bounce once per step
/// and sway once per two steps.
class RootReference {
 public:
  RootReference(const FitModel& model, double frame_time);

  /// False if neither the root nor the hips have a target.
  [[nodiscard]] bool exists() const { return task_ >= 0; }

  /// Step of the filtered target from `frame` to the next frame, metres, world. The target's steps
  /// are mirrored at the ends of the clip, so a constant velocity passes unchanged.
  /// @pre exists() and frame + 1 < clip.frame_count
  [[nodiscard]] Eigen::Vector3d step(const FitClip& clip, int frame) const;

 private:
  int task_ = -1, tasks_ = 0;
  std::vector<double> horizontal_, vertical_;  // Symmetric taps with sum 1.
};

}  // namespace retarget
