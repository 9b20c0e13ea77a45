#include "solve/fit/sunken_frames.h"

#include <algorithm>
#include <vector>

#include "retarget/clip.h"
#include "retarget/kinematic_tree.h"
#include "solve/fit/start_frames.h"
#include "solve/fit/trial_intervals.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

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
    add_trial_interval(
        clip, {std::max(0, frame - every), std::min(clip.frame_count, frame + every + 1)}, found);
  }
  return found;
}

}  // namespace

void solve_sunken_frames(const FitModel& model, const FitOptions& options, FitClip& clip,
                         const std::function<bool()>& keep_going, BranchRecovery& result) {
  if (!options.floor || clip.scene) return;
  TrialPause pause(clip);
  for (const FrameRange& interval : sunken_intervals(model, clip)) {
    if (result.stopped) return;
    if (pause.includes(interval)) continue;
    WindowTrial trial(model, options, clip, keep_going, interval.begin, interval.end);
    const bool accepted = trial.solve() && trial.pays_off();
    result.conclude(trial, accepted);
    pause.conclude(interval, accepted);
  }
}

}  // namespace retarget
