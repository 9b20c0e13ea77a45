#pragma once

#include <optional>

namespace retarget {

/// Follows a sender's clock by ours. Session time is the sender's, and goes on evenly where that
/// clock jumps.
class SenderClock {
 public:
  /// Session time of a frame; nothing: its stamp is far from those before and stands alone so far.
  /// The first frame has its own stamp; a clock has jumped when two stamps in a row say so.
  /// @param stamp    seconds by the sender's clock.
  /// @param arrival  seconds by ours, which never goes back.
  [[nodiscard]] std::optional<double> take(double stamp, double arrival);

  /// What session time it is: that of a frame which comes now, as quickly as the quickest of the
  /// last seconds. Before the first frame: the arrival.
  [[nodiscard]] double now(double arrival) const { return arrival - offset(); }

  /// Another sender comes next: its first frame is of now.
  void restart();

  [[nodiscard]] int jumps() const { return jumps_; }

 private:
  [[nodiscard]] double offset() const;
  void take_offset(double offset, double arrival);

  bool begun_ = false, restarted_ = false;
  double base_ = 0.0;  // session time of the stamp 0
  double last_stamp_ = 0.0, last_arrival_ = 0.0;
  std::optional<double> lone_stamp_;
  int jumps_ = 0;
  // least delays of this stretch of time and the one before it, by our clock against session time
  double least_ = 0.0, least_before_ = 0.0, stretch_begin_ = 0.0;
};

}  // namespace retarget
