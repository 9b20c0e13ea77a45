#include "solve/fit/window_solver.h"

#include <algorithm>
#include <span>
#include <utility>

#include "solve/fit/clip_fitter.h"
#include "solve/fit/frame_costs.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

std::int64_t frames_of(const std::vector<FitWindow>& windows) {
  std::int64_t sum = 0;
  for (const FitWindow& window : windows) sum += window.end - window.begin;
  return sum;
}

}  // namespace

WindowSolver::WindowSolver(const FitModel& model, const FitOptions& options, const FitWindows& plan,
                           FitClip& clip, int threads, bool with_costs)
    : model_(model),
      options_(options),
      plan_(plan),
      clip_(clip),
      threads_(threads),
      with_costs_(with_costs),
      costs_before_(at(clip.frame_count)),
      statuses_(plan.windows.size() + plan.seams.size()),
      all_(std::max<std::int64_t>(
          1, options.iterations * (frames_of(plan.windows) + frames_of(plan.seams)))),
      tasks_(tasks(), threads) {}

std::vector<TaskGraph::Task> WindowSolver::tasks() {
  std::vector<TaskGraph::Task> tasks;
  for (const FitWindow& window : plan_.windows) {
    tasks.push_back({[this, &window, &status = statuses_[tasks.size()]] {
                       if (with_costs_) {
                         const auto begin = at(window.begin), count = at(window.end) - begin;
                         frame_costs(model_, options_, clip_, window,
                                     std::span(costs_before_).subspan(begin, count));
                       }
                       solve(window, status);
                     },
                     1});
  }
  for (std::size_t i = 0; i < plan_.seams.size(); ++i) {
    for (const std::size_t window : {i, i + 1}) tasks[window].then.push_back(tasks.size());
    tasks.push_back(
        {[this, &seam = plan_.seams[i], &status = statuses_[tasks.size()]] { solve(seam, status); },
         2});
  }
  return tasks;
}

void WindowSolver::solve(const FitWindow& window, FitStatus& status) {
  status = fit_window(model_, options_, window, clip_, [&] {
    const auto done = static_cast<double>(done_.fetch_add(window.end - window.begin));
    if (caller_ == std::this_thread::get_id() && keep_going_ &&
        !keep_going_(std::min(1.0, done / static_cast<double>(all_)))) {
      tasks_.stop();
    }
    return !tasks_.stopped();
  });
}

void WindowSolver::starts_are_there(int count) {
  while (released_ < plan_.windows.size() && plan_.frames_needed[released_] <= count) {
    tasks_.release(released_++);
  }
}

bool WindowSolver::finish(const std::function<bool(double done)>& keep_going) {
  keep_going_ = keep_going;
  return tasks_.finish() && !tasks_.stopped();
}

std::vector<TermCosts> WindowSolver::costs_now() const {
  std::vector<TermCosts> costs(at(clip_.frame_count));
  if (!with_costs_) return costs;
  std::vector<TaskGraph::Task> tasks;
  for (const FitWindow& window : plan_.windows) {
    tasks.push_back({[this, &window, &costs] {
      const FitWindow with_neighbours{window.begin, window.end, true,
                                      smoothing_context(clip_.frame_time)};
      const auto begin = at(window.begin), count = at(window.end) - begin;
      frame_costs(model_, options_, clip_, with_neighbours, std::span(costs).subspan(begin, count));
    }});
  }
  TaskGraph(std::move(tasks), threads_).finish();
  return costs;
}

}  // namespace retarget
