#pragma once

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
  [[nodiscard]] bool is_before(WideFrames sample, int frame) const {
    return sample * numerator_ < frame * denominator_;
  }
  [[nodiscard]] bool is_at(WideFrames sample, int frame) const {
    return sample * numerator_ == frame * denominator_;
  }

 private:
  WideFrames numerator_, denominator_;
};

}  // namespace retarget
