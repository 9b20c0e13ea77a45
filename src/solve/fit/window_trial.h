#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "retarget/options.h"
#include "retarget/report.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_dynamics.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Solves a part of a fitted clip again after a change by the caller, and reverts both if they do
/// not lower the cost enough.
///
/// Keeps references to its arguments.
class WindowTrial {
 public:
  WindowTrial(const WindowTrial&) = delete;
  WindowTrial& operator=(const WindowTrial&) = delete;

  /// @param begin, end  frames [begin, end) that the caller will change. The window extends half a
  ///     second beyond them on either side.
  WindowTrial(const FitModel& model, const FitOptions& options, FitClip& clip,
              const std::function<bool()>& keep_going, int begin, int end);

  [[nodiscard]] const FitWindow& window() const { return window_; }
  /// Whether the cost of all terms is clearly lower than at construction and, with dynamics, the
  /// wrench that the contacts cannot supply is not much larger.
  [[nodiscard]] bool pays_off();
  /// Whether the cost of all terms in frames is below this share of that at construction and, with
  /// dynamics, the wrench that the contacts cannot supply is not much larger.
  [[nodiscard]] bool costs_less_than(double share);
  /// Makes solve() use self-collision terms half-way between frames.
  void look_between_frames() { window_.between_frames = true; }
  /// Configuration of a frame of the window at construction.
  [[nodiscard]] std::span<const double> before(int frame) const;

  /// Solves the window between fixed frames, in parts of at most one window length, so that memory
  /// stays bounded.
  /// @return false if keep_going stopped it or a step was not finite.
  bool solve();
  /// Solves the window likewise, with another model and other options.
  bool solve(const FitModel& model, const FitOptions& options);

  /// Restores the clip as it was at construction.
  void revert();

  [[nodiscard]] bool stopped() const { return stopped_; }
  [[nodiscard]] const std::vector<SolverFailure>& failures() const { return failures_; }

 private:
  [[nodiscard]] std::span<double> changed() const;
  [[nodiscard]] double cost() const;

  const FitModel& model_;
  const FitOptions& options_;
  FitClip& clip_;
  const std::function<bool()>& keep_going_;
  FitWindow window_;
  std::vector<double> qpos_before_;
  std::vector<Eigen::Vector2d> anchors_before_;
  double cost_before_ = 0.0;
  std::optional<FitDynamics> dynamics_;
  double unexplained_before_ = 0.0;  // FitDynamics::measure at construction.
  bool stopped_ = false;
  std::vector<SolverFailure> failures_;
};

}  // namespace retarget
