#include "solve/fit/sunken_frames.h"

#include <algorithm>
#include <vector>

#include "retarget/clip.h"
#include "retarget/kinematic_tree.h"
#include "solve/fit/start_frames.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

constexpr double kDeep = 0.01;            // Metres.
constexpr double kDepthSampleTime = 0.1;  // Seconds between two measurements of the depth.
constexpr double kFarApart = 1.0;         // Seconds; intervals less apart are solved together.
constexpr double kLongestSunken = 5.0;    // Seconds of an interval; bounds the memory of a trial.
// Seconds from a rejected trial to the next; it doubles each time, because such a robot probably
// cannot leave the floor.
constexpr double kFirstPause = 1.0, kLongestPause = 32.0;

// Intervals with a deep point, from samples. A penetration that is shorter than the sampling
// interval may be missed.
std::vector<FrameRange> sunken_intervals(const FitModel& model, const FitClip& clip) {
  const int every = std::max(1, clip.frames_in(kDepthSampleTime));
  TreeState pose(model.tree);
  std::vector<FrameRange> found;
  for (int frame = 0; frame < clip.frame_count; frame += every) {
    pose.update(clip.frame(frame, model.configuration_size));
    if (!(lowest_below_floor(model, pose) < -kDeep)) continue;
    const FrameRange next{std::max(0, frame - every),
                          std::min(clip.frame_count, frame + every + 1)};
    if (!found.empty() && next.begin < found.back().end + clip.frames_in(kFarApart) &&
        next.end - found.back().begin <= clip.frames_in(kLongestSunken)) {
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
  double wait = 0.0;
  int next = 0;  // First frame at which an interval may begin.
  for (const auto& [begin, end] : sunken_intervals(model, clip)) {
    if (result.stopped) return;
    if (begin < next) continue;
    WindowTrial trial(model, options, clip, keep_going, begin, end);
    const bool accepted = trial.solve() && trial.pays_off();
    result.conclude(trial, accepted);
    wait = accepted ? 0.0 : std::clamp(2.0 * wait, kFirstPause, kLongestPause);
    if (!accepted) next = end + clip.frames_in(wait);
  }
}

}  // namespace retarget
