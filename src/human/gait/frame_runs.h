#pragma once

namespace retarget {

/// Calls take(begin, end) for each run of frames with equal keys.
template <typename KeyOf, typename Take>
void for_each_run(int begin, int end, const KeyOf& key_of, const Take& take) {
  for (int last = begin; begin < end; begin = last) {
    while (last < end && key_of(last) == key_of(begin)) ++last;
    take(begin, last);
  }
}

}  // namespace retarget
