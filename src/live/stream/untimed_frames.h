#pragma once

namespace retarget {

/// Detects frames without timestamps that arrive faster than those of any sensor, as from a file.
class UntimedFrames {
 public:
  /// Adds a frame. @param arrival  seconds, any clock
  /// @return whether the latest frames arrived too fast.
  [[nodiscard]] bool add(double arrival) {
    constexpr int kFrames = 30;
    constexpr double kFastest = 500.0;  // Frames per second.
    // The body is recognised after the first frame, which takes time.
    if (count_++ == 1) since_ = arrival;
    if (count_ <= kFrames + 1) return false;
    count_ = 1;
    return arrival - since_ < kFrames / kFastest;
  }

 private:
  int count_ = 0;
  double since_ = 0.0;
};

}  // namespace retarget
