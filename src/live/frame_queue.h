#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// Gaps between frames that are bridged, seconds; longer ones interrupt a stream.
inline constexpr double kMaxBridgedGap = 0.25;

/// The latest frames of a stream in the order of their times, whatever order they came in.
class FrameQueue {
 public:
  FrameQueue();

  enum class Taken : unsigned char { kYes, kDoubled, kLate };
  /// @param time  session time, seconds.
  Taken push(double time, const HumanPose& pose);

  enum class Found : unsigned char {
    kYes,
    kNotYet,  ///< There is no frame at or behind this time.
    kGap,     ///< It lies in a gap that is too long to be bridged, or before the first frame.
  };
  /// The human at a time; between two frames by interpolation. Frames that are no longer needed go:
  /// times that are asked for never go back.
  Found sample(double time, HumanPose& pose);

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Of the first frame. @pre not empty
  [[nodiscard]] double first_time() const { return at(0).time; }
  /// Of the first frame behind a time for which sample said kGap.
  [[nodiscard]] double next_time(double time) const;
  /// Seconds from frame to frame, as usual; 0: not known yet.
  [[nodiscard]] double interval() const { return interval_; }
  /// Frames that never came, less those that came out of order.
  [[nodiscard]] long lost() const { return lost_; }

  /// Forgets all frames, not what was counted.
  void clear();

 private:
  struct Slot {
    double time = 0.0;
    HumanPose pose;
  };
  [[nodiscard]] Slot& at(std::size_t i) { return slots_[order_[i]]; }
  [[nodiscard]] const Slot& at(std::size_t i) const { return slots_[order_[i]]; }
  void drop_first(std::size_t frames);
  void learn_interval(double gap);

  static constexpr std::size_t kCapacity = 256;
  std::vector<Slot> slots_;
  std::array<std::size_t, kCapacity> order_{};  // slots by time, the first count_; then free ones
  std::size_t count_ = 0;
  std::array<double, 15> gaps_{};
  std::size_t gap_count_ = 0;
  double interval_ = 0.0;
  long lost_ = 0;
};

}  // namespace retarget
