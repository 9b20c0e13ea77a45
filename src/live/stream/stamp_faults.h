#pragma once

#include <string>

namespace retarget {

/// Detects timestamps that cannot be the times of frames in seconds: constant, falling, or in
/// another unit.
class StampFaults {
 public:
  /// Adds the timestamp of the next frame. @param arrival  seconds, any clock
  /// @return the fault of the latest frames, a sentence; empty: none or not known yet.
  [[nodiscard]] std::string add(double stamp, double arrival);

 private:
  [[nodiscard]] std::string fault(double passed) const;
  void begin(double stamp, double arrival);

  int steps_ = 0, constant_ = 0, falling_ = 0, long_ = 0;
  double first_ = 0.0, last_ = 0.0, arrival_ = 0.0;
  bool has_begun_ = false;
};

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
