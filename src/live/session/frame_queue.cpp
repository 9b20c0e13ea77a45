#include "live/session/frame_queue.h"

#include <algorithm>
#include <cmath>

#include "retarget/so3.h"
#include "retarget/spline.h"

namespace retarget {
namespace {

constexpr double kSameTime = 1e-6;  // seconds

void interpolate(const HumanPose& a, const HumanPose& b, double share, HumanPose& pose) {
  for (const Bone bone : kAllBones) {
    pose[bone] = {interpolate_linear(a[bone].rotation, b[bone].rotation, share),
                  interpolate_linear(a[bone].translation, b[bone].translation, share)};
  }
}

bool is_teleport(const HumanPose& before, const HumanPose& after) {
  const Pose &a = before[Bone::kHips], &b = after[Bone::kHips];
  return (b.translation - a.translation).norm() > kTeleportDistance ||
         log_so3(a.rotation.conjugate() * b.rotation).norm() > kTeleportAngle;
}

}  // namespace

FrameQueue::FrameQueue() : slots_(kCapacity) {
  for (std::size_t i = 0; i < kCapacity; ++i) order_[i] = i;
}

FrameQueue::Taken FrameQueue::push(double time, const HumanPose& pose, double arrival,
                                   double bridged, bool stamped) {
  if (count_ > 0 && time < at(0).time - kSameTime) return Taken::kLate;
  std::size_t place = count_;
  while (place > 0 && at(place - 1).time > time - kSameTime) --place;
  if (place < count_ && at(place).time < time + kSameTime) return Taken::kDoubled;
  if (count_ == kCapacity) {
    drop_first(1);
    if (place == 0) return Taken::kLate;
    --place;
  }
  if (place == count_ && count_ > 0) {
    learn_interval(time - at(count_ - 1).time, stamped);
  } else if (place < count_) {
    lost_ = std::max(0L, lost_ - 1);
  }
  Slot& slot = slots_[order_[count_]];
  slot = {time, arrival, false, pose};
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(place);
  const auto end = order_.begin() + static_cast<std::ptrdiff_t>(count_);
  std::rotate(begin, end, end + 1);
  ++count_;
  see_cut(place, bridged);
  if (place + 1 < count_) see_cut(place + 1, bridged);
  return Taken::kYes;
}

void FrameQueue::see_cut(std::size_t place, double bridged) {
  if (place == 0) return;
  const Slot& before = at(place - 1);
  Slot& slot = at(place);
  const bool teleport = is_teleport(before.pose, slot.pose);
  if (teleport) ++teleports_;
  slot.cut = teleport || slot.time - before.time > bridged;
}

bool FrameQueue::lacks_frames(double gap) const {
  constexpr double kMissing = 1.5;  // Intervals.
  return interval_ > 0.0 && gap > kMissing * interval_;
}

void FrameQueue::learn_interval(double gap, bool stamped) {
  if (gap > kMaxBridgedGap) return;
  if (stamped && lacks_frames(gap)) {
    lost_ += std::lround(gap / interval_) - 1;
  }
  gaps_[gap_count_++ % gaps_.size()] = gap;
  if (gap_count_ < 5) return;
  const std::size_t kept = std::min(gap_count_, gaps_.size());
  std::array<double, 15> sorted = gaps_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(kept);
  const auto middle = sorted.begin() + (end - sorted.begin()) / 2;
  std::nth_element(sorted.begin(), middle, end);
  // Stamps may be rounded, so average the gaps near the median.
  constexpr double kNear = 0.3;  // Fraction of the median.
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    if (std::abs(gaps_[i] - *middle) > kNear * *middle) continue;
    sum += gaps_[i];
    ++count;
  }
  interval_ = sum / count;
}

bool FrameQueue::sample(double time, HumanPose& pose) {
  bool cut = false;
  std::size_t next = 0;
  for (; next < count_ && at(next).time <= time + kSameTime; ++next) {
    cut = cut || at(next).cut;
    at(next).cut = false;
  }
  // The last frame before this time is still needed for interpolation.
  if (next > 1) {
    drop_first(next - 1);
    next = 1;
  }
  const Slot& a = at(0);
  if (next == 0 || count_ == 1 || std::abs(a.time - time) <= kSameTime || at(1).cut) {
    pose = a.pose;
    return cut;
  }
  const Slot& b = at(1);
  interpolate(a.pose, b.pose, (time - a.time) / (b.time - a.time), pose);
  return cut;
}

double FrameQueue::known_since(double time) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (at(i).time >= time - kSameTime) return at(i).arrival;
  }
  return at(count_ - 1).arrival;
}

double FrameQueue::nearest(double time) const {
  double found = at(0).time;
  for (std::size_t i = 1; i < count_; ++i) {
    if (std::abs(at(i).time - time) < std::abs(found - time)) found = at(i).time;
  }
  return found;
}

double FrameQueue::past_cut(double time) const {
  for (std::size_t i = 1; i < count_; ++i) {
    if (at(i).time <= time + kSameTime) continue;
    return at(i).cut && time > at(i - 1).time + kSameTime ? at(i).time : time;
  }
  return time;
}

double FrameQueue::past_gap(double time, double rate) const {
  constexpr double kAlike = 0.8;  // Arrivals against timestamps.
  for (std::size_t i = 1; i < count_; ++i) {
    const Slot &before = at(i - 1), &slot = at(i);
    if (slot.time <= time + kSameTime) continue;
    const double gap = slot.time - before.time;
    const bool is_missed = lacks_frames(gap) && slot.arrival - before.arrival > kAlike * gap / rate;
    return !slot.cut && is_missed ? slot.time : time;
  }
  return time;
}

long FrameQueue::between(double after, double before) const {
  long count = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (at(i).time > after + kSameTime && at(i).time < before - kSameTime) ++count;
  }
  return count;
}

void FrameQueue::drop_first(std::size_t frames) {
  const auto begin = order_.begin();
  std::rotate(begin, begin + static_cast<std::ptrdiff_t>(frames),
              begin + static_cast<std::ptrdiff_t>(count_));
  count_ -= frames;
}

bool FrameQueue::continues_set_back(double time, double arrival, double rate) const {
  constexpr double kNext = 1.5;      // Intervals; consecutive frames are not further apart.
  constexpr double kSetBack = 0.04;  // Seconds; a smaller backward step of a clock is jitter.
  if (!old_ || empty() || time <= newest()) return false;
  const auto& [old_time, old_arrival] = *old_;
  const double since = known_since(newest());
  return old_arrival > since && time - old_time < kNext * interval_ &&
         arrival - since - (time - newest()) / rate > kSetBack;
}

void FrameQueue::clear() {
  old_.reset();
  count_ = 0;
  gap_count_ = 0;
  interval_ = 0.0;
}

}  // namespace retarget
