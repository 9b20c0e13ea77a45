#pragma once

#include <vector>

#include "retarget/clip.h"
#include "solve/fit/fit_clip.h"

namespace retarget {

/// Adds an interval that a trial shall solve again to those of earlier frames. Intervals less than a
/// second apart become one, up to five seconds, which bounds the memory of a trial.
void add_trial_interval(const FitClip& clip, FrameRange next, std::vector<FrameRange>& intervals);

/// The pause after a rejected trial. It doubles each time, because such a robot probably cannot do
/// better. Keeps a reference to the clip.
class TrialPause {
 public:
  explicit TrialPause(const FitClip& clip) : clip_(clip) {}

  [[nodiscard]] bool includes(const FrameRange& interval) const { return interval.begin < next_; }
  void conclude(const FrameRange& interval, bool accepted);

 private:
  const FitClip& clip_;
  double wait_ = 0.0;  // Seconds.
  int next_ = 0;       // First frame at which an interval may begin.
};

}  // namespace retarget
