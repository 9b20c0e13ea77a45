#include "live/frame_queue.h"

#include <algorithm>
#include <cmath>

#include "math/spline.h"
#include "motion/track_sampler.h"

namespace retarget {
namespace {

constexpr double kSameTime = 1e-6;  // seconds

void interpolate(const HumanPose& a, const HumanPose& b, double share, HumanPose& pose) {
  for (const Bone bone : kAllBones) {
    pose[bone] = {interpolate_linear(a[bone].rotation, b[bone].rotation, share),
                  interpolate_linear(a[bone].translation, b[bone].translation, share)};
  }
}

}  // namespace

FrameQueue::FrameQueue() : slots_(kCapacity) {
  for (std::size_t i = 0; i < kCapacity; ++i) order_[i] = i;
}

FrameQueue::Taken FrameQueue::push(double time, const HumanPose& pose) {
  if (count_ > 0 && time < at(0).time - kSameTime) return Taken::kLate;
  std::size_t place = count_;
  while (place > 0 && at(place - 1).time > time - kSameTime) --place;
  if (place < count_ && at(place).time < time + kSameTime) return Taken::kDoubled;
  if (count_ == kCapacity) {
    drop_first(1);
    --place;
  }
  if (place == count_ && count_ > 0) {
    learn_interval(time - at(count_ - 1).time);
  } else if (place < count_) {
    lost_ = std::max(0L, lost_ - 1);
  }
  Slot& slot = slots_[order_[count_]];
  slot.time = time;
  slot.pose = pose;
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(place);
  const auto end = order_.begin() + static_cast<std::ptrdiff_t>(count_);
  std::rotate(begin, end, end + 1);
  ++count_;
  return Taken::kYes;
}

void FrameQueue::learn_interval(double gap) {
  if (gap > kMaxBridgedGap) return;
  constexpr double kMissing = 1.5;  // intervals
  if (interval_ > 0.0 && gap > kMissing * interval_) {
    lost_ += std::lround(gap / interval_) - 1;
  }
  gaps_[gap_count_++ % gaps_.size()] = gap;
  if (gap_count_ < 5) return;
  std::array<double, 15> sorted = gaps_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(gap_count_, gaps_.size()));
  const auto middle = sorted.begin() + (end - sorted.begin()) / 2;
  std::nth_element(sorted.begin(), middle, end);
  interval_ = *middle;
}

FrameQueue::Found FrameQueue::sample(double time, HumanPose& pose) {
  if (count_ == 0) return Found::kNotYet;
  if (time < at(0).time - kSameTime) return Found::kGap;
  std::size_t next = 0;
  while (next < count_ && at(next).time < time - kSameTime) ++next;
  if (next > 1) {
    // the last one before this time is needed yet
    drop_first(next - 1);
    next = 1;
  }
  if (next == count_) return Found::kNotYet;
  const Slot& b = at(next);
  if (std::abs(b.time - time) <= kSameTime) {
    pose = b.pose;
    drop_first(next);
    return Found::kYes;
  }
  const Slot& a = at(next - 1);
  if (b.time - a.time > kMaxBridgedGap) return Found::kGap;
  interpolate(a.pose, b.pose, (time - a.time) / (b.time - a.time), pose);
  return Found::kYes;
}

double FrameQueue::next_time(double time) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (at(i).time >= time - kSameTime) return at(i).time;
  }
  return time;
}

void FrameQueue::drop_first(std::size_t frames) {
  const auto begin = order_.begin();
  std::rotate(begin, begin + static_cast<std::ptrdiff_t>(frames),
              begin + static_cast<std::ptrdiff_t>(count_));
  count_ -= frames;
}

void FrameQueue::clear() {
  count_ = 0;
  gap_count_ = 0;
  interval_ = 0.0;
}

}  // namespace retarget
