#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "retarget/options.h"
#include "retarget/report.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/limb_solver.h"
#include "solve/fit/window_trial.h"

namespace retarget {

/// A limb that moved to another branch: another solution of its inverse kinematics.
struct RecoveredLimb {
  std::string limb;                            ///< Name such as `left arm`.
  int begin = 0, end = 0;                      ///< Frames [begin, end).
  double cost_before = 0.0, cost_after = 0.0;  ///< Tracking cost of the limb, summed over the
                                               ///< frames.
};

/// The changes made to a clip.
struct BranchRecovery {
  std::vector<RecoveredLimb> limbs;  ///< Grouped by limb, in order of time.
  bool stopped = false;              ///< Whether the caller stopped the search; the rest of the
                                     ///< clip is then unprocessed.
  /// Frames in which a solver step was not finite; they stay unchanged.
  std::vector<SolverFailure> failures;

  /// Records the result of a trial.
  /// @param changed  the accepted change; empty: rejects the change and reverts the clip.
  void conclude(WindowTrial& trial, const std::optional<RecoveredLimb>& changed);
  /// Records the result of a trial that moves no limb.
  void conclude(WindowTrial& trial, bool accepted);
  /// One sentence per recovered limb.
  [[nodiscard]] std::vector<std::string> notes() const;
};

/// Tracking cost of a limb whose bones all have a rotation error of 20 degrees. A limb with a
/// higher cost is "astray".
[[nodiscard]] double astray_cost(const FitModel& model, const FitLimb& limb);

/// Searches a fitted clip for arms and legs on a wrong branch and moves them to another branch if
/// that clearly lowers the cost of all terms; then calls straighten_arm() for arms (docs/fit.md),
/// solve_sunken_frames() and solve_crossing_frames().
/// All other frames stay bitwise unchanged.
/// @param keep_going  called periodically; returning false stops the search.
[[nodiscard]] BranchRecovery recover_branches(const FitModel& model, const FitOptions& options,
                                              FitClip& clip,
                                              const std::function<bool()>& keep_going);

}  // namespace retarget
