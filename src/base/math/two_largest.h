#pragma once

#include <algorithm>

namespace retarget {

/// Sum of the two largest of several non-negative numbers. For the movements of bodies, it bounds
/// the movement of any two of them relative to each other.
class TwoLargest {
 public:
  void add(double value) {
    second_ = std::max(second_, std::min(largest_, value));
    largest_ = std::max(largest_, value);
  }
  [[nodiscard]] double sum() const { return largest_ + second_; }

 private:
  double largest_ = 0.0, second_ = 0.0;
};

}  // namespace retarget
