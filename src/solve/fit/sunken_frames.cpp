#include "solve/fit/sunken_frames.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/start_frames.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

constexpr double kDeep = 0.01;            // Metres.
constexpr double kDepthSampleTime = 0.1;  // Seconds between two measurements of the depth.
constexpr double kApart = 1.0;            // Seconds; intervals less apart are solved together.

struct SunkenInterval {
  int begin = 0, end = 0;
};

// Intervals with a deep point, from samples. A penetration that is shorter than the sampling
// interval may be missed.
std::vector<SunkenInterval> sunken_intervals(const FitModel& model, const FitClip& clip) {
  const auto frames_in = [&](double seconds) {
    return std::max(1, static_cast<int>(std::lround(seconds / clip.frame_time)));
  };
  const int every = frames_in(kDepthSampleTime);
  TreeState pose(model.tree);
  std::vector<SunkenInterval> found;
  for (int frame = 0; frame < clip.frame_count; frame += every) {
    pose.update(clip.frame(frame, model.configuration_size));
    if (!(lowest_below_floor(model, pose) < -kDeep)) continue;
    const SunkenInterval next{std::max(0, frame - every),
                              std::min(clip.frame_count, frame + every + 1)};
    if (!found.empty() && next.begin < found.back().end + frames_in(kApart)) {
      found.back().end = next.end;
    } else {
      found.push_back(next);
    }
  }
  return found;
}

}  // namespace

void solve_sunken_frames(const FitModel& model, const FitOptions& options, FitClip& clip,
                         const std::function<bool()>& keep_going, BranchRecovery& result) {
  if (!options.floor || clip.scene) return;
  for (const auto& [begin, end] : sunken_intervals(model, clip)) {
    if (result.stopped) return;
    WindowTrial trial(model, options, clip, keep_going, begin, end);
    result.conclude(trial, trial.solve() && trial.pays_off());
  }
}

}  // namespace retarget
