#include "live/sender_clock.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

constexpr double kJump = 0.5;     // seconds; a frame is never so late or early by itself
constexpr double kAgree = 0.3;    // seconds between the stamps of two frames that say so
constexpr double kStretch = 2.0;  // seconds over which the quickest frame counts

}  // namespace

double SenderClock::offset() const {
  return begun_ ? std::min(least_, least_before_) : 0.0;
}

void SenderClock::take_offset(double offset, double arrival) {
  if (arrival - stretch_begin_ > kStretch) {
    least_before_ = least_;
    least_ = offset;
    stretch_begin_ = arrival;
  }
  least_ = std::min(least_, offset);
}

std::optional<double> SenderClock::take(double stamp, double arrival) {
  if (!begun_) {
    begun_ = true;
    restarted_ = false;
    least_ = least_before_ = arrival - stamp;
    stretch_begin_ = arrival;
  } else if (restarted_) {
    restarted_ = false;
    base_ = now(arrival) - stamp;
  } else {
    const double step = stamp - last_stamp_;
    // frames that were held up on their way come late with steps that are as ever
    const bool jumped = step < -kJump || step > arrival - last_arrival_ + kJump;
    if (jumped) {
      const bool agrees = lone_stamp_ && std::abs(stamp - *lone_stamp_) < kAgree;
      lone_stamp_ = stamp;
      if (!agrees) return std::nullopt;
      base_ = now(arrival) - stamp;
      ++jumps_;
    }
  }
  lone_stamp_.reset();
  last_stamp_ = stamp;
  last_arrival_ = arrival;
  const double time = stamp + base_;
  take_offset(arrival - time, arrival);
  return time;
}

void SenderClock::restart() {
  restarted_ = begun_;
  lone_stamp_.reset();
}

}  // namespace retarget
