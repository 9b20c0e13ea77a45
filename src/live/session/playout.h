#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "live/session/sender_clock.h"
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
};

/// Schedules the output frames: when each frame leaves and which time of the human motion it shows.
///
/// Frames leave on a time grid of the local clock. If input frames arrive at the output frame rate
/// or at a multiple of it, each output frame leaves as soon as its input frame arrives, at most a
/// quarter of a frame before or after the grid. The grid then drifts slowly towards the arrival
/// times; the bounds on gaps and frame count hold and nothing waits. At any other input rate,
/// output frames leave on the grid and show the human with just enough delay that the pose is known
/// whenever a frame leaves. The playback time advances at the sender's rate. It advances faster
/// when more frames are buffered than needed, pauses while frames are missing, and skips input that
/// arrived too late to be made up for.
class Playout {
 public:
  Playout(double frame_time, double delay_s) : frame_time_(frame_time), delay_s_(delay_s) {}

  /// Starts the schedule; the first output frame is due.
  void begin(double now);
  /// Processes the arrival of another frame in the queue.
  void observe(const FrameQueue& queue, const SenderClock& clock);
  /// Reschedules the overdue frame to leave now and drops the slots missed in between.
  /// @return number of dropped slots
  std::int64_t skip_to(double now);
  /// Declares a discontinuity: the next input is unrelated to earlier times.
  void cut() { cut_ = true; }

  struct Slot {
    double at = 0.0;    ///< Departure time, local clock, seconds.
    double step = 0.0;  ///< Time since the previous slot, seconds; after a pause, one frame.
    double time = 0.0;  ///< Session time of the human pose that is shown.
    double since = std::numeric_limits<
        double>::quiet_NaN();  ///< Arrival of this human pose, local clock; set if known.
    bool known = false;  ///< The pose has arrived; otherwise the latest or last one is repeated.
    bool skips = false;  ///< Earlier input was skipped.
  };
  /// Returns the next slot, given the frames received so far.
  [[nodiscard]] Slot next(const FrameQueue& queue, const SenderClock& clock) const;
  /// Commits the slot: its frame leaves.
  void take(const Slot& slot, const FrameQueue& queue, const SenderClock& clock);

  /// The next slot after the end of the input, for a pose that is still to be shown.
  Slot take_rest();

  /// Session time of the human pose shown last; minus infinity before the first one.
  [[nodiscard]] double time() const {
    return first_ ? -std::numeric_limits<double>::infinity() : time_;
  }
  /// Time since a newer human pose was last shown, local clock, seconds.
  [[nodiscard]] double starved() const { return last_at_ - fresh_at_; }

 private:
  [[nodiscard]] double step_until(double at) const;
  void see_margin(double margin, double now, double interval);
  void lock_phase(const Slot& slot);
  [[nodiscard]] double excess(double interval, double age) const;

  double frame_time_, delay_s_;
  double grid_ = 0.0;  // Time at which the next slot is due.
  double not_before_ = -std::numeric_limits<double>::infinity();
  double last_at_ = -std::numeric_limits<double>::infinity();
  double time_ = 0.0;
  bool first_ = true, cut_ = false;
  bool locked_ = true;  // Input frames arrive at the output rate or a multiple of it.
  double gain_ = 0.0;   // Session time by which the next step is extended, seconds.
  double fresh_at_ = 0.0;
  // Smallest margin of received over shown session time, in the current and the previous stretch.
  double least_ = 0.0, least_before_ = 0.0, stretch_end_ = 0.0;
};

}  // namespace retarget
