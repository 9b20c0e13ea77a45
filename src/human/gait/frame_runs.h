#pragma once

#include <algorithm>
#include <cmath>

namespace retarget {

/// Number of frames in a duration, at least 1.
[[nodiscard]] inline int frames_in(double seconds, double frame_time) {
  return std::max(1, static_cast<int>(std::lround(seconds / frame_time)));
}

/// Calls take(begin, end) for each run of frames with equal keys.
template <typename KeyOf, typename Take>
void for_each_run(int begin, int end, const KeyOf& key_of, const Take& take) {
  for (int last = begin; begin < end; begin = last) {
    while (last < end && key_of(last) == key_of(begin)) ++last;
    take(begin, last);
  }
}

/// Calls take(begin, end) for each run of frames for which a condition holds.
template <typename Holds, typename Take>
void for_each_run_where(int begin, int end, const Holds& holds, const Take& take) {
  const auto is_set = [&](int frame) { return static_cast<bool>(holds(frame)); };
  for_each_run(begin, end, is_set, [&](int first, int last) {
    if (is_set(first)) take(first, last);
  });
}

}  // namespace retarget
