#pragma once

#include <array>
#include <cstddef>

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

}  // namespace retarget
