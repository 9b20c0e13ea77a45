#include "solve/fit/clip_fitter.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "solve/fit/fit_dynamics.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/window_steps.h"

namespace retarget {
namespace {

// Predicted decrease, as a share of the cost, above which a window takes extra steps before its
// dynamics. They plan from the current poses, and from poses far from the result they plan wrongly.
constexpr double kSettled = 0.03;
// Penetration, including the self-collision margin, that makes a motion unusable on a robot;
// metres.
constexpr double kDeepOverlap = 0.015;

// The schedule of a window's steps.
class WindowFitter {
 public:
  WindowFitter(const FitModel& model, const FitOptions& options, const FitWindow& window,
               FitClip& clip);

  FitStatus run(const std::function<bool()>& keep_going);

 private:
  bool steps(int begin, int end, const std::function<bool()>& keep_going);
  bool settle(int first_step, const std::function<bool()>& keep_going);
  bool finish(int first_step, const std::function<bool()>& keep_going);
  void add_dynamics(int first_step, const std::function<bool()>& keep_going);

  const FitOptions& options_;
  FitClip& clip_;
  WindowSteps steps_;
  std::optional<FitDynamics> dynamics_;
  bool with_dynamics_ = false;  // Whether the current step includes the dynamics terms.
  int settling_steps_ = 0;
  FitStatus status_;
};

WindowFitter::WindowFitter(const FitModel& model, const FitOptions& options,
                           const FitWindow& window, FitClip& clip)
    : options_(options),
      clip_(clip),
      steps_(model, options, window, clip),
      status_{.begin = window.begin, .end = window.end} {
  if (options.dynamics && FitDynamics::possible(model)) {
    dynamics_.emplace(model, options, window, clip);
  }
}

FitStatus WindowFitter::run(const std::function<bool()>& keep_going) {
  const int first_with_dynamics =
      dynamics_ ? std::max(0, options_.iterations - options_.dynamics_iterations)
                : options_.iterations;
  const bool running = steps(0, first_with_dynamics, keep_going);
  if (!dynamics_) {
    finish(options_.iterations, keep_going);
  } else if (running && settle(first_with_dynamics, keep_going)) {
    add_dynamics(first_with_dynamics + settling_steps_, keep_going);
  }
  status_.converged = !status_.failed && status_.predicted_decrease <= kFitTolerance;
  return status_;
}

// Runs the last steps with dynamics. If dynamics do not help or cannot be computed, restores the
// state and runs these steps without dynamics.
void WindowFitter::add_dynamics(int first_step, const std::function<bool()>& keep_going) {
  const auto take_last_steps = [&] {
    // Without dynamics, the settling steps are some of the window's own steps.
    const int end = with_dynamics_ ? options_.iterations + settling_steps_
                                   : std::max(first_step, options_.iterations);
    return steps(first_step, end, keep_going) && finish(end, keep_going);
  };
  const double unexplained = dynamics_->begin(clip_);
  bool failed = !std::isfinite(unexplained), running = !failed;
  if (!failed && !dynamics_->is_needed()) {
    take_last_steps();
    return;
  }
  const WindowSteps::State before = steps_.state();
  const FitStatus status_before = status_;
  if (!failed) {
    with_dynamics_ = true;
    running = take_last_steps();
    with_dynamics_ = false;
    status_.distrusted_frames = dynamics_->distrusted_frames();
    failed = status_.failed;
  }
  if (!failed && !running) return;
  const double left = failed ? unexplained : dynamics_->measure(clip_);
  failed = failed || !std::isfinite(left);
  if (!failed && dynamics_->has_helped(unexplained, left)) return;
  steps_.restore(before);
  status_ = status_before;
  take_last_steps();
  status_.distrusted_frames = 0;
  // If the window also fails without dynamics, they are not the cause.
  status_.dynamics_failed = failed && !status_.failed;
  status_.dynamics_taken_back = !failed;
}

// @return false if keep_going stopped the fit or a value is not finite.
bool WindowFitter::steps(int begin, int end, const std::function<bool()>& keep_going) {
  for (int i = begin; i < end; ++i) {
    if (keep_going && !keep_going()) return false;
    WindowSteps::Kind kind{.move_anchors = i < options_.anchor_iterations,
                           .look_for_pairs = i % WindowSteps::kPairsEvery == 0,
                           .dynamics = with_dynamics_ ? &*dynamics_ : nullptr};
    if (kind.move_anchors) {
      steps_.place_anchors();
      kind.anchor_hold = steps_.hold_after(i);
    }
    if (with_dynamics_ && !dynamics_->plan(clip_)) {
      status_.failed = true;
      return false;
    }
    steps_.take(kind, status_);
  }
  return true;
}

// Runs extra steps, from `first_step` on, until the window has nearly converged. A window without a
// successful step does not settle.
bool WindowFitter::settle(int first_step, const std::function<bool()>& keep_going) {
  while (status_.steps > 0 && !status_.failed && settling_steps_ < options_.extra_iterations &&
         status_.predicted_decrease > kSettled) {
    const int step = first_step + settling_steps_++;
    if (!steps(step, step + 1, keep_going)) return false;
  }
  return true;
}

// Runs extra steps, from `first_step` on, while the predicted decrease is large, for example for overlapping bodies or a
// body that rises from the floor. With dynamics, the goals change in every step; only windows with
// deep overlaps continue.
bool WindowFitter::finish(int first_step, const std::function<bool()>& keep_going) {
  if (with_dynamics_ && steps_.worst_overlap() <= square(kDeepOverlap)) return true;
  const int end = options_.extra_iterations + (with_dynamics_ ? first_step : options_.iterations);
  for (int i = first_step; i < end; ++i) {
    if (status_.steps == 0 || status_.predicted_decrease <= kFitTolerance) break;
    if (!steps(i, i + 1, keep_going)) return false;
  }
  return true;
}

class WindowMover final : public MovingFit {
 public:
  WindowMover(const FitModel& model, const FitOptions& options, FitClip& clip, int context)
      : steps_(model, options, {0, 0, true, context}, clip) {}

  void move(int begin, int forgotten) override { steps_.move(begin, forgotten); }

  bool step() override {
    status_.failed = false;
    steps_.take({.move_anchors = true}, status_);
    steps_.grow_older();
    steps_.place_anchors();
    return !status_.failed;
  }

 private:
  WindowSteps steps_;
  FitStatus status_;
};

}  // namespace

std::unique_ptr<MovingFit> make_moving_fit(const FitModel& model, const FitOptions& options,
                                           FitClip& clip, int context) {
  return std::make_unique<WindowMover>(model, options, clip, context);
}

FitStatus fit_window(const FitModel& model, const FitOptions& options, const FitWindow& window,
                     FitClip& clip, const std::function<bool()>& keep_going) {
  return WindowFitter(model, options, window, clip).run(keep_going);
}

}  // namespace retarget
