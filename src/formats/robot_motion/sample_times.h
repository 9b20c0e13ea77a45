#pragma once

#include <algorithm>
#include <limits>

#include "retarget/clip.h"

namespace retarget {

// The product of a frame number and the terms of two rates can exceed 64 bits.
__extension__ using WideFrames = __int128;

/// A time between a frame of a clip and the next one.
struct SampleTime {
  int frame = 0;
  double share = 0.0;  ///< Fraction of the time to the next frame, 0 to 1.
};

/// Exact times of samples 0, 1, ... at one rate in the frames of a clip at another.
class SampleTimes {
 public:
  SampleTimes(const FrameRate& clip, const FrameRate& samples)
      : numerator_(WideFrames{clip.frames} * samples.seconds),
        denominator_(WideFrames{clip.seconds} * samples.frames) {}

  [[nodiscard]] SampleTime at(WideFrames sample) const {
    return {static_cast<int>(sample * numerator_ / denominator_),
            static_cast<double>(sample * numerator_ % denominator_) /
                static_cast<double>(denominator_)};
  }
  /// Number of samples before a frame.
  [[nodiscard]] int count_before(int frame) const {
    const WideFrames count = (frame * denominator_ + numerator_ - 1) / numerator_;
    return static_cast<int>(std::min(count, WideFrames{std::numeric_limits<int>::max() - 1}));
  }
  /// Whether a sample coincides with a frame.
  [[nodiscard]] bool has_sample_at(int frame) const {
    return frame * denominator_ % numerator_ == 0;
  }

 private:
  WideFrames numerator_, denominator_;
};

}  // namespace retarget
