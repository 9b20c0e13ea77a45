#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace retarget {

/// Histogram of the times from a packet to the robot frame that it made possible. Its memory does
/// not grow with the duration.
class Latency {
 public:
  void add(double seconds);
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] double max() const { return max_; }
  /// Percentile in seconds, accurate to 5 %; 0 without samples.
  [[nodiscard]] double percentile(double percent) const;

 private:
  std::array<std::int64_t, 400> counts_{};  // Bins; each bound is 5 % larger than the previous one.
  std::int64_t count_ = 0;
  double max_ = 0.0;
};

}  // namespace retarget
