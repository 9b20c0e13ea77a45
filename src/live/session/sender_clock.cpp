#include "live/session/sender_clock.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

constexpr double kFarBack = 0.5;    // Seconds; networks do not reorder frames by more.
constexpr double kFarAhead = 0.5;   // Seconds; frames do not beat the estimated arrival by more.
constexpr double kQuicker = 0.04;   // Seconds; a frame this much faster than the line is rare.
constexpr double kAsQuick = 0.02;   // Seconds; two frames this close are equally fast.
constexpr double kAgreeing = 0.3;   // Seconds; stamps of two frames this close agree.
constexpr double kRecent = 0.4;     // Seconds of recent frames that are searched for a change.
constexpr double kRegular = 0.2;    // Seconds of regular frames that confirm a change.
constexpr double kLate = 0.04;      // Seconds; a smaller delay is jitter.
constexpr double kUneven = 0.012;   // Seconds; maximum deviation from a line for regular frames.
constexpr double kOtherRate = 0.1;  // Relative change of the rate.

}  // namespace

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

// Whether a stamp is implausible as a continuation of the previous ones.
bool SenderClock::is_far(double stamp, double arrival) const {
  if (stamp < last_.stamp - kFarBack) return true;
  if (line_.arrival_of(stamp) - arrival <= kFarAhead) return false;
  // The first frames may have been late, and a different rate becomes visible only gradually.
  return stamp - last_.stamp > kMaxClockRate * (arrival - last_.arrival) + kFarAhead;
}

// Whether an implausible stamp is a clock step rather than a single outlier.
bool SenderClock::is_step(double stamp, double arrival) {
  if (refused_++ == 0) refused_since_ = arrival;
  const bool agrees = lone_ && std::abs(stamp - lone_->stamp) <
                                   std::max(kAgreeing, kMaxClockRate * (arrival - lone_->arrival));
  lone_ = Point{stamp, arrival};
  // If the stamps are inconsistent with each other, the number and duration of refusals decide.
  constexpr int kMany = 3;
  return agrees || (refused_ >= kMany && arrival - refused_since_ >= kRegular);
}

void SenderClock::step_to(double stamp, double arrival) {
  base_ = now(arrival) - stamp;
  line_.restart();
  recent_count_ = 0;
  quicker_ = 0.0;
}

// Whether a frame is the first that is much faster than all previous ones. If the next frame is
// equally fast, either the clock was set forward or the network delay has become shorter. Both have
// the same consequence.
bool SenderClock::is_lone_quick(double stamp, double arrival) {
  const double quicker = line_.arrival_of(stamp) - arrival;
  if (quicker_ > 0.0 && std::abs(quicker) < kAsQuick) {
    base_ -= quicker_ * line_.rate();
    line_.restart();
    recent_count_ = 0;
    quicker_ = 0.0;
    ++jumps_;
    return false;
  }
  quicker_ = 0.0;
  if (quicker < kQuicker + 2.0 * line_.spread()) return false;
  quicker_ = quicker;
  line_.add(stamp, arrival);
  return true;
}

std::optional<double> SenderClock::take(double stamp, double arrival, double used) {
  if (!begun_) {
    begun_ = true;
    restarted_ = false;
  } else if (restarted_) {
    restarted_ = false;
    base_ = now(arrival) - stamp;
    line_.reset();
    recent_count_ = 0;
  } else if (is_far(stamp, arrival)) {
    if (!is_step(stamp, arrival)) return std::nullopt;
    step_to(stamp, arrival);
    ++jumps_;
  } else if (is_lone_quick(stamp, arrival)) {
    last_ = {stamp, arrival};
    return std::nullopt;
  }
  lone_.reset();
  refused_ = 0;
  last_ = {stamp, arrival};
  remember(stamp, arrival);
  constexpr double kFree = 0.25;  // Seconds; later frames do not affect the minimum delay.
  if (line_.empty() || arrival - line_.arrival_of(stamp) < kFree) line_.add(stamp, arrival);
  if (has_changed()) anchor(used);
  return stamp + base_;
}

void SenderClock::remember(double stamp, double arrival) {
  // Spread the buffer's entries over the time window that is searched.
  const double apart = kRecent / static_cast<double>(recent_.size());
  if (recent_count_ > 0) {
    const Point& last = recent_[(recent_count_ - 1) % recent_.size()];
    if (arrival - last.arrival < apart && stamp > last.stamp) return;
  }
  recent_[recent_count_++ % recent_.size()] = {stamp, arrival};
}

// Whether the latest frames are regular and either share a common delay or have a different rate.
bool SenderClock::has_changed() const {
  const std::size_t kept = std::min(recent_count_, recent_.size());
  const auto recent = [&](std::size_t back) -> const Point& {
    return recent_[(recent_count_ - 1 - back) % recent_.size()];
  };
  if (kept == 0) return false;
  const Point& latest = recent(0);
  std::size_t count = 0;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, least = HUGE_VAL, most = -HUGE_VAL;
  while (count < kept && latest.arrival - recent(count).arrival <= kRecent) {
    const Point& point = recent(count);
    if (count > 0 && point.stamp >= recent(count - 1).stamp) break;
    const double s = point.stamp - latest.stamp, a = point.arrival - latest.arrival;
    const double late = point.arrival - line_.arrival_of(point.stamp);
    // This frame precedes the change.
    if (count > 1 && latest.arrival - point.arrival >= kRegular && late < kLate && least > kLate)
      break;
    least = std::min(least, late);
    most = std::max(most, late);
    x += s, y += a, xx += s * s, xy += s * a;
    ++count;
  }
  constexpr std::size_t kFew = 4;
  if (count < kFew || latest.arrival - recent(count - 1).arrival < kRegular) return false;
  const auto n = static_cast<double>(count);
  const double width = xx - x * x / n;
  if (width <= 0.0) return false;
  const double slope = (xy - x * y / n) / width, level = (y - slope * x) / n;
  double off = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = recent(i).stamp - latest.stamp, a = recent(i).arrival - latest.arrival;
    off = std::max(off, std::abs(a - level - slope * s));
  }
  if (off > kUneven + 2.0 * line_.spread() || slope * kMaxClockRate < 1.0 ||
      slope * kMinClockRate > 1.0)
    return false;
  if (least > kLate && most - least < kLate + 2.0 * line_.spread()) return true;
  constexpr double kSure = 4.0;
  const double doubt = kSure * off / std::sqrt(width);
  return std::abs(slope * line_.rate() - 1.0) > kOtherRate + doubt * line_.rate();
}

// Restarts the estimate from the latest frames only.
void SenderClock::anchor(double used) {
  const double session_now = now(last_.arrival);
  const std::size_t kept = std::min(recent_count_, recent_.size());
  line_.restart();
  for (std::size_t back = kept; back-- > 0;) {
    const Point& point = recent_[(recent_count_ - 1 - back) % recent_.size()];
    if (last_.arrival - point.arrival <= kRegular) line_.add(point.stamp, point.arrival);
  }
  ++anchored_;
  if (last_.stamp + base_ > used) return;
  // The clock was set back; without a new offset, all following frames would count as late.
  base_ = session_now - last_.stamp;
  ++jumps_;
  ++set_back_;
}

void SenderClock::restart() {
  restarted_ = begun_;
  lone_.reset();
  refused_ = 0;
  quicker_ = 0.0;
}

}  // namespace retarget
