#pragma once

#include <span>
#include <vector>

#include "retarget/options.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/root_reference.h"

namespace retarget {

/// The cost of a step from one frame to the next, for one degree of freedom. Half of it is
/// weight/2 (change of the step)^2 + force (change of the step).
struct StepTerm {
  double weight = 0.0;
  double force = 0.0;
};

/// The cost terms that couple neighbouring frames. Each degree of freedom is coupled only with
/// itself:
///
///     (w / dt)^2 |v - s|^2    v the step, s the smoothed step: argmin |v - s|^2 + (T/dt)^2 |D s|^2
///     (u / dt)^2 max(0, |v| - limit dt)^2
///
/// For the root position, v in the first term is the step minus smoothness_root_reference times
/// RootReference's, so that only accelerations that the target does not have cost anything.
///
/// s is recomputed before every iteration. With L = D'D and l = (T/dt)^2, eliminating s turns the
/// first term into (w / dt)^2 v' l L (1 + l L)^-1 v; for small T this penalises accelerations with
/// the weight (w T)^2. Its exact second derivative couples more distant frames. No eigenvalue of L
/// exceeds 4, so (w / dt)^2 4 l / (1 + 4 l) times the identity bounds it from above. That bound
/// couples only neighbours and makes every step lower the cost.
class JointSpeeds {
 public:
  JointSpeeds(const FitModel& model, const FitOptions& options, double frame_time);

  /// Reads the steps of frames [first, last).
  void update(const FitModel& model, const FitClip& clip, int first, int last);

  /// Terms of the step from `frame` to the next one. update() must have read this step.
  void terms(int frame, std::span<StepTerm> terms) const;
  void add_costs(int frame, TermCosts& costs) const;

 private:
  [[nodiscard]] const double* row(const std::vector<double>& values, int frame) const {
    return values.data() + static_cast<std::size_t>(frame - first_) * smooth_weight_.size();
  }

  RootReference root_;
  double root_share_;                  // Of the reference.
  std::vector<double> smooth_weight_;  // (w / dt)^2, by dof.
  std::vector<double> soft_step_;      // By dof: step at which the speed term sets in.
  double speed_weight_;                // (u / dt)^2.
  double smoothing_;                   // (T / dt)^2.
  double stiffness_;                   // Largest share of the weight that remains after smoothing.
  int first_ = 0;
  std::vector<double> steps_, smooth_, factors_;
};

}  // namespace retarget
