#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "fit/fit_windows.h"
#include "fit/frame_terms.h"
#include "fit/task_graph.h"
#include "retarget/options.h"
#include "retarget/report.h"

namespace retarget {

/// Solves the windows of a clip and their seams, each as soon as what it needs is there: windows
/// while the first stage is still on its way through the frames behind them, seams when both windows
/// are done. None reads a frame that another one at that time writes, so the result is the same for
/// any number of threads.
///
/// Keeps references to all that it is made from.
class WindowSolver {
 public:
  WindowSolver(const FitModel& model, const FitOptions& options, const FitWindows& plan,
               FitClip& clip, int threads);

  /// The first `count` frames have their start.
  void starts_are_there(int count);
  /// The caller's thread helps until all is solved.
  /// @param keep_going  asked on the caller's thread with the share that is done; false stops.
  /// @return whether all is solved.
  bool finish(const std::function<bool(double done)>& keep_going);

  /// By frame: what the starts cost, each within its window.
  [[nodiscard]] const std::vector<TermCosts>& costs_before() const { return costs_before_; }
  /// Of each window, then of each seam: how it ended.
  [[nodiscard]] const std::vector<FitStatus>& statuses() const { return statuses_; }
  /// By frame: what the clip costs now.
  [[nodiscard]] std::vector<TermCosts> costs_now() const;

 private:
  void solve(const FitWindow& window, FitStatus& status);
  [[nodiscard]] std::vector<TaskGraph::Task> tasks();

  const FitModel& model_;
  const FitOptions& options_;
  const FitWindows& plan_;
  FitClip& clip_;
  int threads_;
  std::vector<TermCosts> costs_before_;
  std::vector<FitStatus> statuses_;
  std::size_t released_ = 0;  // windows that may begin
  std::thread::id caller_ = std::this_thread::get_id();
  std::function<bool(double)> keep_going_;  // the caller's thread alone looks at it
  std::atomic<std::int64_t> done_ = 0;      // frames, once for each iteration
  std::int64_t all_;
  // last, for its threads use all of the above
  TaskGraph tasks_;
};

}  // namespace retarget
