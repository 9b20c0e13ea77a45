#include "live/session/skew_line.h"

#include <algorithm>
#include <cmath>

namespace retarget {

void SkewLine::restart() {
  const double rate = rate_;
  reset();
  prior_ = rate_ = rate;
}

void SkewLine::add(double stamp, double arrival) {
  if (keep({stamp, arrival})) fit();
}

// @return whether the points have changed
bool SkewLine::keep(const Point& point) {
  while (count_ > 1 && at(0).arrival < point.arrival - kWindow) {
    first_ = (first_ + 1) % kRoom;
    --count_;
  }
  if (count_ > 0 && point.arrival < bucket_begin_ + kBucket) {
    if (count_ > 1 && point.stamp <= at(count_ - 2).stamp) return false;
    Point& last = at(count_ - 1);
    const double delay = point.arrival - arrival_of(point.stamp);
    if (delay > last.arrival - arrival_of(last.stamp)) return false;
    last = point;
    return true;
  }
  if (count_ > 0 && point.stamp <= at(count_ - 1).stamp) return false;
  if (count_ == kRoom) {
    first_ = (first_ + 1) % kRoom;
    --count_;
  }
  bucket_begin_ = point.arrival;
  at(count_++) = point;
  return true;
}

// Places a line of the given slope below all points so that it touches one.
void SkewLine::lay(double slope) {
  double least = HUGE_VAL, sum = 0.0;
  const Point origin = at(0);
  for (std::size_t i = 0; i < count_; ++i) {
    const double above = (at(i).arrival - origin.arrival) - slope * (at(i).stamp - origin.stamp);
    least = std::min(least, above);
    sum += above;
  }
  stamp_ = origin.stamp;
  arrival_ = origin.arrival + least;
  rate_ = 1.0 / slope;
  spread_ = sum / static_cast<double>(count_) - least;
}

void SkewLine::fit() {
  constexpr double kMinSpan = 0.1;         // Seconds; a shorter span does not determine a rate.
  constexpr double kDoubtful = 3.0;        // Spreads over the span; a smaller drift may be jitter.
  constexpr double kLeastMeaning = 0.004;  // Seconds over the span; a smaller drift is ignored.
  std::size_t corners = 0;
  double mean = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Point& point = at(i);
    mean += point.stamp - at(0).stamp;
    // Remove a corner that lies on or above the line from its predecessor to this point.
    while (corners > 1) {
      const Point &a = hull_[corners - 2], &b = hull_[corners - 1];
      const double turn = (b.stamp - a.stamp) * (point.arrival - a.arrival) -
                          (b.arrival - a.arrival) * (point.stamp - a.stamp);
      if (turn > 0.0) break;
      --corners;
    }
    hull_[corners++] = point;
  }
  mean = at(0).stamp + mean / static_cast<double>(count_);
  const double prior = 1.0 / prior_;
  const double span = at(count_ - 1).arrival - at(0).arrival;
  if (corners < 2 || span < kMinSpan) {
    lay(prior);
    return;
  }
  std::size_t edge = 1;
  while (edge + 1 < corners && hull_[edge].stamp < mean) ++edge;
  const double slope =
      (hull_[edge].arrival - hull_[edge - 1].arrival) / (hull_[edge].stamp - hull_[edge - 1].stamp);
  lay(std::clamp(slope, 1.0 / kMaxClockRate, 1.0 / kMinClockRate));
  const double doubt = (kDoubtful * spread_ + kLeastMeaning) / span;
  if (std::abs(slope - prior) < doubt) lay(prior);
}

}  // namespace retarget
