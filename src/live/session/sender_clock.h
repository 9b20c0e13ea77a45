#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

namespace retarget {

/// Range of plausible clock rates, sender against local clock. Stamps that imply another rate are
/// rejected.
inline constexpr double kMinClockRate = 0.4, kMaxClockRate = 2.5;

/// Estimates offset and rate of a sender's clock from the stamps and arrivals of its frames. The
/// estimate is the line below all points (stamp, arrival) with the least sum of delays (Moon,
/// Skelly, Towsley: "Estimation and removal of clock skew from network delay measurements", INFOCOM
/// 1999). That line is the edge of the lower convex hull at the mean stamp, so no linear program
/// has to be solved. It uses the fastest point of each 0.05 s in the last 10 s.
class SkewLine {
 public:
  /// Adds the next frame. Frames that arrive out of order are ignored.
  void add(double stamp, double arrival);
  /// Discards all points but keeps the rate until new points determine another one.
  void restart();
  /// Restores the state after construction.
  void reset() { *this = SkewLine(); }

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Arrival time of a frame that is not delayed.
  [[nodiscard]] double arrival_of(double stamp) const {
    return arrival_ + (stamp - stamp_) / rate_;
  }
  /// Stamp of the frame that arrives at this time if it is not delayed.
  [[nodiscard]] double stamp_at(double arrival) const {
    return stamp_ + (arrival - arrival_) * rate_;
  }
  /// Sender seconds per local second.
  [[nodiscard]] double rate() const { return rate_; }
  /// Mean delay above the line, seconds.
  [[nodiscard]] double spread() const { return spread_; }

 private:
  struct Point {
    double stamp = 0.0, arrival = 0.0;
  };
  static constexpr double kBucket = 0.05, kWindow = 10.0;  // seconds
  static constexpr std::size_t kRoom = 224;

  [[nodiscard]] const Point& at(std::size_t i) const { return points_[(first_ + i) % kRoom]; }
  [[nodiscard]] Point& at(std::size_t i) { return points_[(first_ + i) % kRoom]; }
  bool keep(const Point& point);
  void fit();
  void lay(double slope);

  std::array<Point, kRoom> points_{}, hull_{};
  std::size_t first_ = 0, count_ = 0;
  double bucket_begin_ = 0.0;
  double prior_ = 1.0;  // Rate used where the points do not determine one.
  // The line: a point on it, its rate, and the mean delay above it.
  double stamp_ = 0.0, arrival_ = 0.0, rate_ = 1.0, spread_ = 0.0;
};

/// Estimates offset and rate of a sender's clock against the local one, and detects steps of either
/// clock or of the delay between them. Session time follows the sender's clock but continues evenly
/// when that clock steps.
class SenderClock {
 public:
  /// Converts the stamp of a frame to session time. The first frame's session time is its stamp.
  /// Returns nothing if the stamp is implausible and not confirmed by others. The clock has stepped
  /// when two frames in a row agree on the step, or when all frames of 0.2 s share a common delay.
  /// @param stamp    sender's clock, seconds.
  /// @param arrival  local monotonic clock, seconds.
  /// @param used     session time up to which frames were consumed; earlier frames are useless.
  [[nodiscard]] std::optional<double> take(double stamp, double arrival,
                                           double used = -std::numeric_limits<double>::infinity());

  /// Current session time: that of a frame that arrives now with minimum delay. Before the first
  /// frame, the arrival time.
  [[nodiscard]] double now(double arrival) const {
    return line_.empty() ? arrival : line_.stamp_at(arrival) + base_;
  }
  /// Session seconds per local second.
  [[nodiscard]] double rate() const { return line_.rate(); }
  /// Mean delay of frames above the minimum delay, local seconds.
  [[nodiscard]] double jitter() const { return line_.spread(); }

  /// Declares a new sender; its first frame is mapped to the current session time.
  void restart();

  /// Number of steps of the sender's clock.
  [[nodiscard]] int jumps() const { return jumps_; }
  /// Number of backward steps among them after which frames counted as late for a while.
  [[nodiscard]] int set_back() const { return set_back_; }
  /// Number of times that offset and rate were re-estimated because the delay or the rate changed.
  [[nodiscard]] int anchored() const { return anchored_; }

 private:
  struct Point {
    double stamp = 0.0, arrival = 0.0;
  };
  [[nodiscard]] bool is_far(double stamp, double arrival) const;
  [[nodiscard]] bool is_step(double stamp, double arrival);
  [[nodiscard]] bool is_lone_quick(double stamp, double arrival);
  void step_to(double stamp, double arrival);
  void remember(double stamp, double arrival);
  [[nodiscard]] bool has_changed() const;
  void anchor(double used);

  bool begun_ = false, restarted_ = false;
  double base_ = 0.0;  // Session time of stamp 0.
  SkewLine line_;
  Point last_;                 // Last accepted frame.
  std::optional<Point> lone_;  // Last rejected frame.
  double quicker_ = 0.0;       // Lead of the last frame over all earlier ones, seconds; 0: none.
  double refused_since_ = 0.0;
  int refused_ = 0;
  int jumps_ = 0, set_back_ = 0, anchored_ = 0;
  std::array<Point, 64> recent_{};  // Ring buffer.
  std::size_t recent_count_ = 0;
};

}  // namespace retarget
