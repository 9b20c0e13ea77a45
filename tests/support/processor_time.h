#pragma once

#include <algorithm>
#include <ctime>

namespace retarget {

/// Returns the processor time of this process in seconds; other processes do not change it.
inline double processor_time() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Returns the processor time of `run(large)` divided by that of `run(small)`, each the minimum of three runs: about
/// large / small if it is linear.
template <typename Run>
double time_growth(const Run& run, int small, int large) {
  constexpr double kResolution = 0.001;  // Of the clock on Windows, seconds.
  const auto fastest = [&](int size) {
    double seconds = 1e9;
    for (int i = 0; i < 3; ++i) {
      const double begin = processor_time();
      run(size);
      seconds = std::min(seconds, processor_time() - begin);
    }
    return std::max(seconds, kResolution);
  };
  return fastest(large) / fastest(small);
}

}  // namespace retarget
