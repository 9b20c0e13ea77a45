#pragma once

#include <span>
#include <vector>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "fit/frame_terms.h"
#include "retarget/options.h"

namespace retarget {

/// What a step from a frame to the next adds to the cost, for one degree of freedom: half of it is
/// weight/2 (change of the step)^2 + force (change of the step).
struct StepTerm {
  double weight = 0.0;
  double force = 0.0;
};

/// The terms of the cost that couple neighbouring frames. Those are few numbers, for they couple
/// each degree of freedom with itself alone:
///
///     (w / dt)^2 |v - s|^2    v the step, s the smoothed step: argmin |v - s|^2 + (T/dt)^2 |D s|^2
///     (u / dt)^2 max(0, |v| - limit dt)^2
///
/// s is brought up to date before every iteration. With L = D'D and l = (T/dt)^2 what is left of the
/// first line is (w / dt)^2 v' l L (1 + l L)^-1 v: for small T a penalty of accelerations, (w T)^2
/// their weight. Its exact second derivative has further neighbours; as no eigenvalue of L is above
/// 4, (w / dt)^2 4 l / (1 + 4 l) times the unit matrix is never below it, couples neighbours alone,
/// and with it every step lowers the cost.
class JointSpeeds {
 public:
  JointSpeeds(const FitModel& model, const FitOptions& options, double frame_time);

  /// Takes the steps of frames [first, last).
  void update(const FitModel& model, const FitClip& clip, int first, int last);

  /// Of the step from `frame` to the next one, which must be among those taken.
  void terms(int frame, std::span<StepTerm> terms) const;
  void add_costs(int frame, TermCosts& costs) const;

 private:
  [[nodiscard]] const double* row(const std::vector<double>& values, int frame) const {
    return values.data() + static_cast<std::size_t>(frame - first_) * smooth_weight_.size();
  }

  std::vector<double> smooth_weight_;  // by dof; w / dt squared
  std::vector<double> soft_step_;      // by dof; where the speed's term begins
  double speed_weight_;                // u / dt squared
  double smoothing_;                   // T / dt squared
  double stiffness_;                   // largest share of the weight that smoothing leaves
  int first_ = 0;
  std::vector<double> steps_, smooth_, factors_;
};

}  // namespace retarget
