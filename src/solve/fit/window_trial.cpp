#include "solve/fit/window_trial.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "solve/fit/clip_fitter.h"
#include "solve/fit/frame_costs.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

constexpr double kMargin = 0.5;   // Seconds before and after the change that are also solved.
constexpr double kOverlap = 1.5;  // Seconds of overlap between parts.

}  // namespace

WindowTrial::WindowTrial(const FitModel& model, const FitOptions& options, FitClip& clip,
                         const std::function<bool()>& keep_going, int begin, int end)
    : model_(model),
      options_(options),
      clip_(clip),
      keep_going_(keep_going),
      window_{std::max(0, begin - clip.frames_in(kMargin)),
              std::min(clip.frame_count, end + clip.frames_in(kMargin)), true,
              smoothing_context(clip.frame_time)},
      anchors_before_(clip.anchors) {
  const auto solved = changed();
  qpos_before_.assign(solved.begin(), solved.end());
  cost_before_ = cost();
  if (options.dynamics && FitDynamics::possible(model)) {
    dynamics_.emplace(model, options, window_, clip);
    unexplained_before_ = dynamics_->begin(clip);
  }
}

std::span<double> WindowTrial::changed() const {
  const auto size = at(model_.configuration_size);
  return std::span(clip_.qpos)
      .subspan(at(window_.begin) * size, at(window_.end - window_.begin) * size);
}

std::span<const double> WindowTrial::before(int frame) const {
  const auto size = at(model_.configuration_size);
  return std::span(qpos_before_).subspan(at(frame - window_.begin) * size, size);
}

double WindowTrial::cost() const {
  // The window's frames also affect the smoothed steps of the frames before and after it.
  const int margin = window_.context + 1;
  const FitWindow all{std::max(0, window_.begin - margin),
                      std::min(clip_.frame_count, window_.end + margin), true, window_.context};
  std::vector<TermCosts> costs(at(all.end - all.begin));
  frame_costs(model_, options_, clip_, all, costs);
  double sum = 0.0;
  for (const TermCosts& cost : costs) sum = std::accumulate(cost.begin(), cost.end(), sum);
  return sum;
}

bool WindowTrial::pays_off() {
  constexpr double kLessInAll = 0.97;  // Share of the cost that may remain.
  return costs_less_than(kLessInAll);
}

bool WindowTrial::costs_less_than(double share) {
  // Tolerated increase of the unexplained wrench, because a faster limb needs larger forces: a
  // ratio; a share of the robot's weight.
  constexpr double kMoreForce = 1.2, kForceNoise = 0.03;
  if (!(cost() < share * cost_before_)) return false;
  return !dynamics_ || dynamics_->measure(clip_) <= kMoreForce * unexplained_before_ + kForceNoise;
}

bool WindowTrial::solve() {
  return solve(model_, options_);
}

bool WindowTrial::solve(const FitModel& model, const FitOptions& options) {
  const int length = std::max(clip_.frames_in(options.window), 2 * clip_.frames_in(kOverlap) + 1);
  const int count = (window_.end - window_.begin + length - 1) / length;
  const auto border = [&](int i) {
    return window_.begin +
           static_cast<int>(static_cast<std::int64_t>(window_.end - window_.begin) * i / count);
  };
  for (int i = 0; i < count; ++i) {
    const int begin = std::max(window_.begin, border(i) - (i > 0 ? clip_.frames_in(kOverlap) : 0));
    const FitWindow part{begin, border(i + 1), true, window_.context, window_.between_frames};
    const FitStatus status = fit_window(model, options, part, clip_, [this] {
      stopped_ = stopped_ || (keep_going_ && !keep_going_());
      return !stopped_;
    });
    if (status.failed) {
      failures_.push_back({"fit", part.begin, part.end});
      return false;
    }
  }
  return !stopped_;
}

void WindowTrial::revert() {
  std::ranges::copy(qpos_before_, changed().begin());
  clip_.anchors = anchors_before_;
}

}  // namespace retarget
