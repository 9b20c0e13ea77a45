#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "retarget/options.h"
#include "retarget/report.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/fit_windows.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/task_graph.h"

namespace retarget {

/// Solves the windows and seams of a clip, each as soon as its inputs are complete: a window while
/// the first stage still solves later frames, a seam once both of its windows are solved. No task
/// reads a frame that a concurrent task writes, so the result does not depend on the number of
/// threads.
///
/// Keeps references to its arguments.
class WindowSolver {
 public:
  /// @param with_costs  whether to measure costs; false: all costs are 0.
  WindowSolver(const FitModel& model, const FitOptions& options, const FitWindows& plan,
               FitClip& clip, int threads, bool with_costs);

  /// Starts the windows that need no more than the first `count` frames. Call it when the first
  /// stage has solved these frames.
  void starts_are_there(int count);
  /// Solves on the caller's thread, too, until all windows and seams are solved.
  /// @param keep_going  called on the caller's thread with the completed share of the work, 0 to 1;
  ///     returning false stops the solver.
  /// @return true if all windows and seams are solved.
  bool finish(const std::function<bool(double done)>& keep_going);

  /// Cost of the start by frame, evaluated within the frame's window.
  [[nodiscard]] const std::vector<TermCosts>& costs_before() const { return costs_before_; }
  /// Final status of each window, then of each seam.
  [[nodiscard]] const std::vector<FitStatus>& statuses() const { return statuses_; }
  /// Cost of the current clip by frame.
  [[nodiscard]] std::vector<TermCosts> costs_now() const;

 private:
  void solve(const FitWindow& window, FitStatus& status);
  [[nodiscard]] std::vector<TaskGraph::Task> tasks();

  const FitModel& model_;
  const FitOptions& options_;
  const FitWindows& plan_;
  FitClip& clip_;
  int threads_;
  bool with_costs_;
  std::vector<TermCosts> costs_before_;
  std::vector<FitStatus> statuses_;
  std::size_t released_ = 0;  // Number of windows whose input is complete.
  std::thread::id caller_ = std::this_thread::get_id();
  std::function<bool(double)> keep_going_;  // Used only on the caller's thread.
  std::atomic<std::int64_t> done_ = 0;      // Sum over all steps of their number of frames.
  std::int64_t all_;                        // Value of done_ at the end, without extra steps.
  // Declared last, because its threads use all members above.
  TaskGraph tasks_;
};

}  // namespace retarget
