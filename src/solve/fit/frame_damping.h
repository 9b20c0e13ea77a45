#pragma once

#include <cstddef>
#include <vector>

#include "solve/fit/fit_model.h"

namespace retarget {

/// Levenberg-Marquardt damping of a window, one factor per frame. It grows if a step raised the
/// cost of the frame and decays otherwise.
class FrameDamping {
 public:
  /// The only state between steps.
  struct State {
    std::vector<double> factors, costs;
  };

  /// @param slides  the window moves with a stream. Its frames take few steps, so they are damped in
  ///     proportion to the whole diagonal: they must not overshoot.
  FrameDamping(const FitModel& model, std::size_t frames, bool slides);

  /// Adapts the factor of a frame to its cost before the step.
  void adapt(std::size_t frame, double cost);
  /// Damps the frame as strongly as possible in the next step.
  void maximise(std::size_t frame);

  /// Damping of a degree of freedom, for the Hessian diagonal of the frame.
  [[nodiscard]] double of(std::size_t frame, std::size_t dof, double diagonal) const;

  /// Drops the first frames of a moving window; new frames at its end are not damped.
  void move(std::size_t dropped, std::size_t frames);

  [[nodiscard]] const State& state() const { return state_; }
  void set_state(const State& state) { state_ = state; }

 private:
  State state_;
  std::vector<double>
      largest_;  // By degree of freedom: curvature to which a factor refers at most.
};

}  // namespace retarget
