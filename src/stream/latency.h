#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace retarget {

/// Times from a packet to the robot frame that it made possible: kept by size, so that an hour needs
/// no more room than a second.
class Latency {
 public:
  void add(double seconds);
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] double max() const { return max_; }
  /// Seconds that a share of all are within, to 5 %; 0 without any.
  [[nodiscard]] double percentile(double percent) const;

 private:
  std::array<std::int64_t, 400> counts_{};  // by size: each 5 % larger than the one before
  std::int64_t count_ = 0;
  double max_ = 0.0;
};

}  // namespace retarget
