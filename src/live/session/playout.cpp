#include "live/session/playout.h"

#include <algorithm>
#include <cmath>

#include "live/session/motion_limiter.h"

namespace retarget {
namespace {

constexpr double kSame = 1e-6;     // seconds
constexpr double kEarly = 0.25;    // Frames; how early a frame may leave before the grid.
constexpr double kWait = 0.25;     // Frames; how long past the grid a frame waits for its input.
constexpr double kMinStep = 0.45;  // Frames; minimum interval between two departures.
constexpr double kMostEarlier = 0.005, kMostLater = 0.02;  // Frames; grid shift per output frame.
constexpr double kStretch = 0.1;                           // seconds
constexpr double kSkip = 0.15;                             // Seconds; later input is skipped.
constexpr double kCatchUp = 0.1;                           // Seconds; time constant of catching up.
constexpr double kMinGain = 0.02, kMaxGain = 0.5;          // Fraction of a step.
constexpr double kSnap = 0.25;  // Steps; an input frame this near is used without interpolation.

}  // namespace

void Playout::begin(double now) {
  grid_ = now + delay_s_;
  fresh_at_ = last_at_ = grid_;
  first_ = true;
  stretch_end_ = grid_ + kStretch;
}

// Detects whether input frames arrive at the output rate or at a multiple of it.
void Playout::observe(const FrameQueue& queue, const SenderClock& clock) {
  if (delay_s_ > 0.0) {
    locked_ = false;
    return;
  }
  if (queue.interval() <= 0.0) return;
  constexpr double kEnter = 0.01, kLeave = 0.03;
  const double times = clock.rate() * frame_time_ / queue.interval();
  const double whole = std::round(times);
  locked_ = whole >= 1.0 && std::abs(times / whole - 1.0) < (locked_ ? kLeave : kEnter);
}

std::int64_t Playout::skip_to(double now) {
  const double missed = std::max(0.0, std::floor((now - grid_) / frame_time_));
  grid_ += missed * frame_time_;
  not_before_ = now;
  return static_cast<std::int64_t>(missed);
}

Playout::Slot Playout::next(const FrameQueue& queue, const SenderClock& clock) const {
  Slot slot;
  slot.at = grid_;
  slot.time = time_;
  const double step = clock.rate() * frame_time_;
  if (!queue.empty()) {
    const double newest = queue.newest();
    const double wanted =
        first_ ? (delay_s_ > 0.0 ? queue.first_time() : newest) : time_ + step + gain_;
    const double skip = clock.rate() * (kSkip + delay_s_) + 2.0 * queue.interval();
    // A gap that was received in time is interpolated; it does not make its frames late.
    const double since = starved() < kSkip ? queue.past_gap(wanted, clock.rate()) : wanted;
    if (cut_ || newest - since > skip) {
      slot.skips = !first_;
      slot.time = first_ ? wanted : std::max(time_, newest - clock.rate() * delay_s_);
      slot.known = newest > time_ + kSame || first_;
    } else {
      slot.time = queue.past_cut(wanted);
      if (locked_ && !first_ && gain_ == 0.0) {
        const double near = queue.nearest(wanted);
        if (std::abs(near - wanted) < kSnap * step && near > time_ + kSame) slot.time = near;
      }
      slot.known = newest >= slot.time - kSame;
    }
    if (slot.known) {
      slot.since = queue.known_since(slot.time);
    } else {
      slot.time = std::max(time_, std::min(slot.time, newest));
    }
  }
  if (locked_ && !first_) {
    const double latest = grid_ + kWait * frame_time_;
    if (!slot.known) {
      if (starved() < kStretch) slot.at = latest;
    } else if (slot.since >= grid_ - kEarly * frame_time_) {
      slot.at = std::min(slot.since, latest);
    }
  }
  slot.at = std::max(slot.at, not_before_);
  slot.at = std::max(slot.at, last_at_ + (first_ ? 0.0 : kMinStep * frame_time_));
  slot.step = step_until(slot.at);
  return slot;
}

double Playout::step_until(double at) const {
  constexpr double kRounding = 1e-9;  // seconds
  const double step = at - last_at_;
  const bool is_even = std::abs(step - frame_time_) < kRounding;
  return first_ || is_even || step > MotionLimiter::kLongestStep * frame_time_ ? frame_time_ : step;
}

void Playout::take(const Slot& slot, const FrameQueue& queue, const SenderClock& clock) {
  const double newest = queue.empty() ? slot.time : queue.newest();
  if (slot.time > time_ + kSame || (first_ && slot.known) || slot.skips) fresh_at_ = slot.at;
  if (slot.skips) least_ = least_before_ = 0.0;
  grid_ += frame_time_;
  if (slot.known && locked_ && !first_) lock_phase(slot);
  // A late slot must not shorten the interval to the next one.
  grid_ = std::max(grid_, slot.at + (1.0 - kEarly - kWait) * frame_time_);
  last_at_ = slot.at;
  time_ = slot.time;
  first_ = first_ && !slot.known;
  cut_ = cut_ && !slot.known;
  least_ -= gain_;
  least_before_ -= gain_;
  gain_ = 0.0;
  see_margin(slot.known ? newest - time_ : 0.0, slot.at, queue.interval());
  const double age = clock.now(slot.at) - time_ - clock.rate() * delay_s_;
  const double more = excess(queue.interval(), age);
  const double step = clock.rate() * frame_time_;
  if (more > 0.0) gain_ = step * std::clamp(more / (kCatchUp * clock.rate()), kMinGain, kMaxGain);
}

Playout::Slot Playout::take_rest() {
  Slot slot;
  slot.at = std::max(grid_, last_at_ + (1.0 - kEarly) * frame_time_);
  slot.step = step_until(slot.at);
  slot.time = time_;
  grid_ = slot.at + frame_time_;
  last_at_ = slot.at;
  return slot;
}

// Shifts the grid towards the arrival times, slowly so that the output rate stays bounded.
void Playout::lock_phase(const Slot& slot) {
  constexpr double kShare = 0.1;
  double phase = std::fmod(slot.since - (grid_ - frame_time_), frame_time_);
  if (phase > 0.5 * frame_time_) phase -= frame_time_;
  if (phase < -0.5 * frame_time_) phase += frame_time_;
  grid_ += std::clamp(kShare * phase, -kMostEarlier * frame_time_, kMostLater * frame_time_);
}

// Tracks the minimum margin over enough frames that it does not depend on their phase to the grid.
void Playout::see_margin(double margin, double now, double interval) {
  constexpr double kFrames = 3.0;
  if (now >= stretch_end_) {
    least_before_ = least_;
    least_ = margin;
    stretch_end_ = now + std::max(kStretch, kFrames * interval);
  }
  least_ = std::min(least_, margin);
}

// Margin beyond the required one, seconds; 0 if negligible.
double Playout::excess(double interval, double age) const {
  constexpr double kSpare = 0.4, kLeast = 0.002;  // Intervals; seconds.
  double more = std::min(least_, least_before_);
  if (delay_s_ > 0.0) more = std::min(more, age);
  const double spare = locked_ ? kSnap * frame_time_ : kSpare * interval + kLeast;
  return more > spare ? more : 0.0;
}

}  // namespace retarget
