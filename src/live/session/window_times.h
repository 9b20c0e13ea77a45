#pragma once

#include <cstddef>
#include <vector>

namespace retarget {

/// Session times of the frames in a solver's window.
class WindowTimes {
 public:
  /// @param frames  length of the window; 0: there is none, and frames neither enter nor leave.
  explicit WindowTimes(int frames) : times_(static_cast<std::size_t>(frames)) {}

  void enter(double time) { times_[entered_++ % times_.size()] = time; }
  /// The oldest frame leaves. Until the next one leaves, the robot shows its time.
  void leave() { time_ = times_[left_++ % times_.size()]; }
  /// Time of the frame that left last.
  [[nodiscard]] double time() const { return time_; }
  void restart() { entered_ = left_ = 0; }

 private:
  std::vector<double> times_;  // A ring buffer.
  std::size_t entered_ = 0, left_ = 0;
  double time_ = 0.0;
};

}  // namespace retarget
