#include "solve/fit/trial_intervals.h"

#include <algorithm>

namespace retarget {

void add_trial_interval(const FitClip& clip, FrameRange next, std::vector<FrameRange>& intervals) {
  constexpr double kFarApart = 1.0, kLongest = 5.0;  // Seconds.
  if (!intervals.empty() && next.begin < intervals.back().end + clip.frames_in(kFarApart) &&
      next.end - intervals.back().begin <= clip.frames_in(kLongest)) {
    intervals.back().end = next.end;
  } else {
    intervals.push_back(next);
  }
}

void TrialPause::conclude(const FrameRange& interval, bool accepted) {
  constexpr double kFirstPause = 1.0, kLongestPause = 32.0;  // Seconds.
  wait_ = accepted ? 0.0 : std::clamp(2.0 * wait_, kFirstPause, kLongestPause);
  if (!accepted) next_ = interval.end + clip_.frames_in(wait_);
}

}  // namespace retarget
