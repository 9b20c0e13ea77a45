#pragma once

#include <cstdint>
#include <limits>

#include "live/session/frame_queue.h"
#include "live/session/sender_clock.h"

namespace retarget {

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
