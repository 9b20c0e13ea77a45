#include "app/plan/time_planner.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

constexpr double kEase = 0.2;       // Change of the pace from knot to knot at most.
constexpr double kPaceStep = 1e-4;  // Coefficients are multiples of this.
constexpr double kMaxPace = 1.0 / kLeastTimeScale;
// If an interval was slowed by more than kTried, its severity must be below this share of the
// first.
constexpr double kTried = 1.3, kNoHelp = 0.75;

}  // namespace

TimePlanner::TimePlanner(double duration, const FrameRate& rate)
    : duration_(duration), rate_(rate), warp_(scale_, duration) {
  const auto places =
      static_cast<std::size_t>(std::max(1.0, std::ceil(duration / scale_.knot_time)));
  for (auto& of_kind : needs_) of_kind.resize(places);
}

double TimePlanner::source_time(int step) const {
  return std::min(duration_, warp_.source_time(rate_.time_of(step)));
}

std::size_t TimePlanner::place(double source) const {
  return std::min(static_cast<std::size_t>(std::max(0.0, source) / scale_.knot_time),
                  needs_[0].size() - 1);
}

bool TimePlanner::take(const std::vector<StepNeed>& needs) {
  bool changed = false;
  for (const StepNeed& need : needs) {
    const double from = source_time(need.step), to = source_time(need.step + 1);
    for (std::size_t i = place(from); i <= place(to); ++i) {
      changed |= raise(needs_[need.kind][i], need, warp_.pace(0.5 * (from + to)));
    }
  }
  if (changed) set_pace();
  return changed;
}

bool TimePlanner::raise(PlaceNeed& need, const StepNeed& step, double pace) const {
  if (need.is_hopeless) return false;
  if (need.first == 0.0) {
    need.first = step.severity;
    need.cause = step.cause;
  }
  if (pace > kTried && step.severity > kNoHelp * need.first) {
    need.is_hopeless = true;
    need.pace = 1.0;
    return true;
  }
  const double wanted = std::min(kMaxPace, pace * step.slower);
  if (wanted <= need.pace + kPaceStep) return false;
  need.pace = wanted;
  return true;
}

void TimePlanner::restore(double begin, double end) {
  for (std::size_t i = place(begin); i <= place(end); ++i) {
    for (auto& of_kind : needs_) {
      of_kind[i].is_hopeless = of_kind[i].is_hopeless || of_kind[i].first > 0.0;
      of_kind[i].pace = 1.0;
    }
  }
  set_pace();
}

// A segment depends on four coefficients, so all of them must be as large as it needs.
void TimePlanner::set_pace() {
  std::vector<double>& pace = scale_.pace;
  pace.assign(needs_[0].size() + 3, 1.0);
  for (const auto& of_kind : needs_) {
    for (std::size_t i = 0; i < of_kind.size(); ++i) {
      for (std::size_t k = i; k < i + 4; ++k) pace[k] = std::max(pace[k], of_kind[i].pace);
    }
  }
  for (std::size_t k = 1; k < pace.size(); ++k) pace[k] = std::max(pace[k], pace[k - 1] - kEase);
  for (std::size_t k = pace.size() - 1; k-- > 0;) pace[k] = std::max(pace[k], pace[k + 1] - kEase);
  for (double& each : pace)
    each = std::clamp(std::ceil(each / kPaceStep) * kPaceStep, 1.0, kMaxPace);
  warp_ = TimeWarp(scale_, duration_);
}

std::optional<TimeScale> TimePlanner::decision() {
  find_stretches();
  if (scale_.stretches.empty()) scale_.pace.clear();
  if (scale_.stretches.empty() && scale_.left.empty()) return std::nullopt;
  return scale_;
}

void TimePlanner::find_stretches() {
  scale_.stretches.clear();
  scale_.left.clear();
  scale_.longer = warp_.duration() - duration_;
  bool inside = false;
  double strongest = 1.0;
  for (std::size_t i = 0; i < needs_[0].size(); ++i) {
    const double begin = static_cast<double>(i) * scale_.knot_time;
    const double end = std::min(duration_, begin + scale_.knot_time);
    const double pace =
        std::max({warp_.pace(begin), warp_.pace(0.5 * (begin + end)), warp_.pace(end)});
    if (pace <= 1.0 + kPaceStep) {
      add_left(i, begin, end);
      inside = false;
      continue;
    }
    if (!inside) {
      scale_.stretches.push_back({begin, end, 1.0, {}});
      strongest = 1.0;
    }
    inside = true;
    SlowedStretch& stretch = scale_.stretches.back();
    stretch.end = end;
    stretch.factor = std::min(stretch.factor, 1.0 / pace);
    for (const auto& of_kind : needs_) {
      if (of_kind[i].pace <= strongest) continue;
      strongest = of_kind[i].pace;
      stretch.cause = of_kind[i].cause;
    }
  }
}

void TimePlanner::add_left(std::size_t i, double begin, double end) {
  for (const auto& of_kind : needs_) {
    if (!of_kind[i].is_hopeless) continue;
    const bool continues = !scale_.left.empty() && scale_.left.back().end >= begin - 1e-9;
    if (!continues) scale_.left.push_back({begin, end, 1.0, of_kind[i].cause});
    scale_.left.back().end = end;
  }
}

}  // namespace retarget
