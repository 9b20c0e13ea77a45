#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// Longest gap between frames that is bridged by interpolation, seconds. A longer gap is a cut.
inline constexpr double kMaxBridgedGap = 0.25;
/// Largest plausible motion of the hips between two frames; beyond it, tracking was lost and
/// regained.
inline constexpr double kTeleportDistance = 1.0;           // metres, of the hips
inline constexpr double kTeleportAngle = 1.0471975511966;  // radians, 60 degrees, of the hips

/// Buffers the latest frames of a stream, sorted by time regardless of arrival order.
class FrameQueue {
 public:
  FrameQueue();

  enum class Taken : unsigned char { kYes, kDoubled, kLate };
  /// Inserts a frame.
  /// @param time     session time, seconds.
  /// @param arrival  local clock, seconds.
  /// @param bridged  longest gap that is interpolated, seconds of session time.
  /// @param stamped  whether the time is a timestamp of the sender. Arrival times do not show
  ///     whether a frame is missing.
  Taken push(double time, const HumanPose& pose, double arrival, double bridged = kMaxBridgedGap,
             bool stamped = true);

  /// Samples the human pose at a time. Interpolates between two frames; before a cut, repeats the
  /// frame before it. Discards frames that are no longer needed, so the requested times must not
  /// decrease.
  /// @pre not empty, time no later than newest().
  /// @return whether a cut lies between the previously requested time and this one.
  bool sample(double time, HumanPose& pose);

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Times of the first and the last frame. @pre not empty
  [[nodiscard]] double first_time() const { return at(0).time; }
  [[nodiscard]] double newest() const { return at(count_ - 1).time; }
  /// Arrival time of the first frame that covers a session time. @pre no later than newest()
  [[nodiscard]] double known_since(double time) const;
  /// Frame time nearest to the given time. @pre not empty
  [[nodiscard]] double nearest(double time) const;
  /// Returns the time itself, or the time of the frame after the cut if it lies in a cut.
  [[nodiscard]] double past_cut(double time) const;
  /// Returns the time of the next frame if frames before it are missing and interpolated, otherwise
  /// the time itself. If the timestamps alone leave a gap, none is missing.
  /// @param rate  session seconds per local second.
  [[nodiscard]] double past_gap(double time, double rate) const;
  /// Number of frames between two times.
  [[nodiscard]] long between(double after, double before) const;
  /// Typical frame interval, seconds of session time; 0 while unknown.
  [[nodiscard]] double interval() const { return interval_; }
  /// Number of frames that never arrived, corrected for frames that arrived out of order.
  [[nodiscard]] long lost() const { return lost_; }
  /// Number of cuts at which the human's position or orientation jumped between two frames.
  [[nodiscard]] long teleports() const { return teleports_; }

  /// Records a frame that is not newer than all frames before it, even if the queue lacks it.
  void note_old(double time, double arrival) { old_ = {time, arrival}; }
  /// Whether a frame continues a sender's clock that was set back slightly: its predecessor counted
  /// as old, and less time has passed by the stamps than by the arrivals. The human moved meanwhile.
  /// @param rate  session seconds per local second.
  [[nodiscard]] bool continues_set_back(double time, double arrival, double rate) const;

  /// Discards all frames but keeps the counters.
  void clear();

 private:
  struct Slot {
    double time = 0.0, arrival = 0.0;
    bool cut = false;  // Unrelated to the frame before it.
    HumanPose pose;
  };
  [[nodiscard]] Slot& at(std::size_t i) { return slots_[order_[i]]; }
  [[nodiscard]] const Slot& at(std::size_t i) const { return slots_[order_[i]]; }
  void drop_first(std::size_t frames);
  [[nodiscard]] bool lacks_frames(double gap) const;
  void learn_interval(double gap, bool stamped);
  void see_cut(std::size_t place, double bridged);

  static constexpr std::size_t kCapacity = 256;
  std::vector<Slot> slots_;
  std::array<std::size_t, kCapacity> order_{};  // Slots by time (first count_), then free.
  std::size_t count_ = 0;
  std::array<double, 15> gaps_{};
  std::size_t gap_count_ = 0;
  double interval_ = 0.0;
  long lost_ = 0, teleports_ = 0;
  std::optional<std::pair<double, double>> old_;  // Time and arrival of the last old frame.
};

}  // namespace retarget
