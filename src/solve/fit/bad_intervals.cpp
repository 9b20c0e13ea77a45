#include "solve/fit/bad_intervals.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/math/two_largest.h"
#include "retarget/clip.h"
#include "retarget/kinematic_tree.h"
#include "robot/model/half_way.h"
#include "solve/fit/half_way.h"
#include "solve/fit/near_pairs.h"
#include "solve/fit/start_frames.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

// Adds an interval to those of earlier frames. Intervals less than a second apart become one, up to
// five seconds, which bounds the memory of a trial.
void add_interval(const FitClip& clip, FrameRange next, std::vector<FrameRange>& intervals) {
  constexpr double kFarApart = 1.0, kLongest = 5.0;  // Seconds.
  if (!intervals.empty() && next.begin < intervals.back().end + clip.frames_in(kFarApart) &&
      next.end - intervals.back().begin <= clip.frames_in(kLongest)) {
    intervals.back().end = next.end;
  } else {
    intervals.push_back(next);
  }
}

// Solves intervals again.
// @param attempt  solves a trial; whether its result is accepted.
void solve_again(const FitModel& model, const FitOptions& options, FitClip& clip,
                 const std::function<bool()>& keep_going, const std::vector<FrameRange>& intervals,
                 const std::function<bool(WindowTrial&)>& attempt, BranchRecovery& result) {
  constexpr double kFirstPause = 1.0, kLongestPause = 32.0;  // Seconds.
  double wait = 0.0;                                         // Seconds.
  int next = 0;  // First frame at which an interval may begin.
  for (const FrameRange& interval : intervals) {
    if (result.stopped) return;
    if (interval.begin < next) continue;
    WindowTrial trial(model, options, clip, keep_going, interval.begin, interval.end);
    const bool accepted = attempt(trial);
    result.conclude(trial, accepted);
    // The pause doubles after each rejected trial, because such a robot probably cannot do better.
    wait = accepted ? 0.0 : std::clamp(2.0 * wait, kFirstPause, kLongestPause);
    if (!accepted) next = interval.end + clip.frames_in(wait);
  }
}

constexpr double kDeep = 0.01;            // Metres.
constexpr double kDepthSampleTime = 0.1;  // Seconds between two measurements of the depth.

// Intervals with a deep point, from samples. A penetration that is shorter than the sampling
// interval may be missed.
std::vector<FrameRange> sunken_intervals(const FitModel& model, const FitClip& clip) {
  const int every = std::max(1, clip.frames_in(kDepthSampleTime));
  TreeState pose(model.tree);
  std::vector<FrameRange> found;
  for (int frame = 0; frame < clip.frame_count; frame += every) {
    pose.update(clip.frame(frame, model.configuration_size));
    if (!(lowest_below_floor(model, pose) < -kDeep)) continue;
    add_interval(clip, {std::max(0, frame - every), std::min(clip.frame_count, frame + every + 1)},
                 found);
  }
  return found;
}

constexpr double kDeepCrossing = 0.01;  // Depth from which an overlap is removed, metres.
// Distance in one of two frames up to which shapes may pass through each other between them, metres.
constexpr double kMayCross = 0.04;

// Measures overlaps of a fitted clip's shapes in frames and half-way between them.
class OverlapMeter {
 public:
  OverlapMeter(const FitModel& model, const FitClip& clip)
      : model_(model),
        clip_(clip),
        now_(model.tree),
        before_(model.tree),
        half_way_(model),
        near_in_frames_(model),
        near_half_way_(model) {}

  // Moves to a frame, as the first one of a sequence.
  void begin(int frame) {
    frame_ = frame;
    now_.update(configuration(frame_));
  }
  void next() {
    ++frame_;
    std::swap(now_, before_);
    now_.update(configuration(frame_));
  }

  // Depth of the deepest overlap half-way from the frame before, of shapes that pass through each
  // other; metres, 0 without one.
  [[nodiscard]] double depth_half_way() {
    if (!has_fast_shapes()) return 0.0;
    half_way_.update(configuration(frame_ - 1), configuration(frame_));
    near_half_way_.find(half_way_.pose(), 0.0, overlapping_);
    double deepest = 0.0;
    for (const std::uint32_t pair : overlapping_) {
      if (!may_cross(model_, before_, now_, pair) || !is_near(pair)) continue;
      deepest = std::max(deepest, -pair_distance(model_, half_way_.pose(), pair));
    }
    return deepest;
  }
  // The same in the frame, of all shapes.
  [[nodiscard]] double depth() {
    near_in_frames_.find(now_, 0.0, overlapping_);
    double deepest = 0.0;
    for (const std::uint32_t pair : overlapping_) {
      deepest = std::max(deepest, -pair_distance(model_, now_, pair));
    }
    return deepest;
  }

 private:
  [[nodiscard]] std::span<const double> configuration(int frame) const {
    return clip_.frame(frame, model_.configuration_size);
  }
  [[nodiscard]] bool is_near(std::uint32_t pair) const {
    return pair_distance(model_, before_, pair) < kMayCross ||
           pair_distance(model_, now_, pair) < kMayCross;
  }
  // Whether two shapes may move by more than kPassing relative to each other.
  [[nodiscard]] bool has_fast_shapes() const {
    const Eigen::Vector3d base = now_.origin() - before_.origin();
    TwoLargest movements;
    for (const FitShape& shape : model_.shapes) {
      const auto link = static_cast<std::size_t>(shape.link);
      const Eigen::Vector3d step =
          now_.world_from_link[link] * shape.centre - before_.world_from_link[link] * shape.centre;
      movements.add((step - base).norm());
    }
    return movements.sum() > kPassing;
  }

  const FitModel& model_;
  const FitClip& clip_;
  int frame_ = 0;
  TreeState now_, before_;
  HalfWay half_way_;
  NearPairs near_in_frames_, near_half_way_;
  std::vector<std::uint32_t> overlapping_;
};

// Intervals with a deep overlap half-way between frames.
std::vector<FrameRange> crossing_intervals(OverlapMeter& meter, const FitClip& clip) {
  std::vector<FrameRange> found;
  meter.begin(0);
  for (int frame = 1; frame < clip.frame_count; ++frame) {
    meter.next();
    if (!(meter.depth_half_way() > kDeepCrossing)) continue;
    add_interval(clip, {frame - 1, frame + 1}, found);
  }
  return found;
}

struct Overlaps {
  double sum = 0.0;      // Of all overlaps deeper than kDeepCrossing, in frames and between them.
  double deepest = 0.0;  // In a frame.
};

Overlaps overlaps_of(OverlapMeter& meter, const FitWindow& window) {
  Overlaps found;
  const auto add = [&](double depth) { found.sum += depth > kDeepCrossing ? depth : 0.0; };
  for (int frame = window.begin; frame < window.end; ++frame) {
    if (frame == window.begin) {
      meter.begin(frame);
    } else {
      meter.next();
      add(meter.depth_half_way());
    }
    const double depth = meter.depth();
    found.deepest = std::max(found.deepest, depth);
    add(depth);
  }
  return found;
}

// Whether overlaps between frames became smaller and did not move into frames.
bool is_better(const Overlaps& after, const Overlaps& before) {
  constexpr double kLess = 0.5;  // Share of the overlaps that may remain.
  return after.sum < kLess * before.sum && after.deepest <= std::max(before.deepest, kDeepCrossing);
}

}  // namespace

void solve_sunken_frames(const FitModel& model, const FitOptions& options, FitClip& clip,
                         const std::function<bool()>& keep_going, BranchRecovery& result) {
  if (!options.floor || clip.scene) return;
  solve_again(
      model, options, clip, keep_going, sunken_intervals(model, clip),
      [](WindowTrial& trial) { return trial.solve() && trial.pays_off(); }, result);
}

void solve_crossing_frames(const FitModel& model, const FitOptions& options, FitClip& clip,
                           const std::function<bool()>& keep_going, BranchRecovery& result) {
  constexpr double kMoreCost = 1.05;  // Ratio by which the cost of all terms may rise.
  if (!options.self_collision || model.pairs.empty() || clip.frame_count < 2) return;
  OverlapMeter meter(model, clip);
  FitOptions patient = options;
  patient.iterations *= 2;
  const auto attempt = [&](WindowTrial& trial) {
    const Overlaps before = overlaps_of(meter, trial.window());
    trial.look_between_frames();
    return trial.solve(model, patient) && is_better(overlaps_of(meter, trial.window()), before) &&
           trial.costs_less_than(kMoreCost);
  };
  solve_again(model, options, clip, keep_going, crossing_intervals(meter, clip), attempt, result);
}

}  // namespace retarget
