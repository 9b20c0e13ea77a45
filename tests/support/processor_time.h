#pragma once

#include <algorithm>
#include <ctime>

namespace retarget {

/// Returns the processor time of this process in seconds; other processes do not change it.
inline double processor_time() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Returns the processor time of `work` in seconds, the minimum over some runs.
template <typename Work>
double least_processor_time(int runs, const Work& work) {
  double least = 1e9;
  for (int i = 0; i < runs; ++i) {
    const double begin = processor_time();
    work();
    least = std::min(least, processor_time() - begin);
  }
  return least;
}

/// Returns the processor time of `work(large)` divided by that of `work(small)`, each the minimum of three runs: about
/// large / small if it is linear.
template <typename Work>
double time_growth(const Work& work, int small, int large) {
  constexpr double kResolution = 0.001;  // Of the clock on Windows, seconds.
  const auto time_of = [&](int size) {
    return std::max(kResolution, least_processor_time(3, [&] { work(size); }));
  };
  return time_of(large) / time_of(small);
}

}  // namespace retarget
