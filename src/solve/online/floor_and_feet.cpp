#include "solve/online/floor_and_feet.h"

#include <algorithm>
#include <cmath>

#include "human/gait/source_feet.h"
#include "solve/fit/fit_setup.h"
#include "solve/fit/start_frames.h"

namespace retarget {

TrackedFoot::TrackedFoot(const FitModel& model, const FitTask& task, double frame_time)
    : target_(task.target),
      foot_(task.foot),
      body_height_(model.feet[static_cast<std::size_t>(task.foot)].body_height),
      frame_time_(frame_time) {
  constexpr double kSpeedTime = 0.05;  // seconds
  const Side side =
      model.feet[static_cast<std::size_t>(task.foot)].left ? Side::kLeft : Side::kRight;
  ankle_ = side_bone(side, LimbBone::kFoot);
  toe_ = side_bone(side, LimbBone::kToe);
  apart_ = static_cast<std::size_t>(
      std::clamp(std::lround(kSpeedTime / frame_time), 1L, static_cast<long>(latest_.size()) - 1));
}

void TrackedFoot::add(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
                      const Eigen::Vector3d& path) {
  const Pose& toe = world_from_bone[toe_];
  const Ends now{world_from_bone[ankle_].translation, toe.translation};
  latest_[count_ % latest_.size()] = now;
  const std::size_t apart = std::min(count_, apart_);
  speed_ = 0.0;
  if (apart > 0) {
    const Ends& before = latest_[(count_ - apart) % latest_.size()];
    speed_ = std::max((now.ankle - before.ankle).norm(), (now.toe - before.toe).norm()) /
             (static_cast<double>(apart) * frame_time_);
  }
  ++count_;
  up_ = (toe.rotation * Eigen::Vector3d::UnitY()).z();
  sole_height_ = world_from_target[static_cast<std::size_t>(target_)].translation.z() + path.z() -
                 body_height_;
}

std::vector<TrackedFoot> tracked_feet(const FitModel& model, double frame_time) {
  std::vector<TrackedFoot> feet;
  for (const FitTask& task : model.tasks) {
    if (task.foot >= 0) feet.emplace_back(model, task, frame_time);
  }
  return feet;
}

FloorFinder::FloorFinder(const FitOptions& options, double frame_time)
    : frame_time_(frame_time), max_speed_(options.contact_speed) {
  constexpr double kFloorSpeed = 0.1;  // m/s
  step_ = kFloorSpeed * frame_time;
}

void FloorFinder::restart() {
  count_ = level_count_ = 0;
  wait_ = 0;
  begun_ = false;
}

// Median height of the stances at the lowest level; higher ones may be on steps or boxes.
double FloorFinder::estimate() {
  constexpr double kLowestShare = 0.05;
  constexpr double kLevel = 0.05;  // metres
  const std::size_t count = std::min(count_, heights_.size());
  const auto begin = scratch_.begin(), end = begin + static_cast<std::ptrdiff_t>(count);
  std::copy_n(heights_.begin(), count, begin);
  const auto low = begin + static_cast<std::ptrdiff_t>(kLowestShare * static_cast<double>(count));
  std::nth_element(begin, low, end);
  const double top = *low + kLevel;
  const auto level = std::partition(begin, end, [&](double height) { return height <= top; });
  const auto middle = begin + (level - begin) / 2;
  std::nth_element(begin, middle, level);
  return *middle;
}

// The latest vertical jump of the source's world, metres; 0: none. No body moves like this: root
// and lower sole are shifted together, and much farther than an acceleration allows between two
// frames in which the root hardly moves. A step or the take-off of a jump raises the root while a
// foot is on the floor; in the air, the root only slows down.
double FloorFinder::jump() const {
  constexpr double kLongest = 0.12;      // Seconds; the source's frames may be this far apart.
  constexpr double kLeast = 0.03;        // Metres.
  constexpr double kAcceleration = 8.0;  // m/s^2
  constexpr double kCalm = 0.15;         // Share of the jump per frame, before and after it.
  constexpr double kTogether = 0.75;     // Share of the root's movement.
  const auto longest = static_cast<std::size_t>(std::lround(kLongest / frame_time_));
  for (std::size_t n = 1; n <= std::clamp(longest, std::size_t{1}, levels_.size() - 3); ++n) {
    if (level_count_ < n + 3) break;
    const Level &before = level(n + 1), &after = level(1);
    const double moved = after.root - before.root;
    const double earlier = before.root - level(n + 2).root, later = level(0).root - after.root;
    const double calm = kCalm * std::abs(moved);
    if (std::max(std::abs(earlier), std::abs(later)) > calm) continue;
    const double shift = moved - 0.5 * static_cast<double>(n) * (earlier + later);
    const double time = (static_cast<double>(n) - 0.5) * frame_time_;
    if (std::abs(shift) < kLeast + kAcceleration * time * time) continue;
    if ((after.sole - before.sole) / moved < kTogether) continue;
    return shift;
  }
  return 0.0;
}

// Shifts the known stances by a jump of the world.
void FloorFinder::follow_jump(const Level& now) {
  levels_[level_count_++ % levels_.size()] = now;
  const double shift = jump();
  if (shift == 0.0) return;
  for (double& height : heights_) height += shift;
  goal_ += shift;
  levels_[0] = now;
  level_count_ = 1;
}

double FloorFinder::add(std::span<const TrackedFoot> feet, double lowest_part, double root) {
  constexpr int kWait = 8;         // Frames between two estimates.
  constexpr double kStands = 0.5;  // Minimum TrackedFoot::up of a stance.
  if (feet.empty()) return 0.0;
  double lowest = HUGE_VAL;
  for (const TrackedFoot& foot : feet) lowest = std::min(lowest, foot.sole_height());
  follow_jump({root, lowest});
  bool stands = false;
  for (const TrackedFoot& foot : feet) {
    if (foot.speed() > max_speed_ || foot.up() < kStands) continue;
    heights_[count_++ % heights_.size()] = foot.sole_height();
    stands = true;
  }
  if (!begun_) {
    constexpr double kClearly = 0.1, kDepth = 0.05;  // Metres; the depth is that of a body.
    begun_ = true;
    floor_ = goal_ = lowest_part < lowest - kClearly ? lowest_part - kDepth : lowest;
  }
  if (stands && wait_-- <= 0) {
    wait_ = kWait;
    goal_ = estimate();
  }
  floor_ += std::clamp(goal_ - floor_, -step_, step_);
  return floor_;
}

namespace {

// Largest shift of a target, metres; beyond it, the foot is released.
constexpr double kMaxShift = 0.03;
// Time constants of applying a shift, of releasing it, and of moving the root to the floor;
// seconds.
constexpr double kEaseTime = 0.04, kReleaseTime = 0.1, kSettleTime = 0.08;

// Share of a difference that remains after a frame, for a time constant.
double share_left(double frame_time, double time) {
  return time / (time + frame_time);
}

}  // namespace

FootHolder::FootHolder(const FitModel& model, const FitOptions& options, double frame_time,
                       std::size_t feet)
    : model_(model),
      options_(options),
      size_(model.leg / kUsualSourceLeg),
      ease_(share_left(frame_time, kEaseTime)),
      release_(share_left(frame_time, kReleaseTime)),
      settle_(share_left(frame_time, kSettleTime)),
      held_(feet),
      pose_(model.tree) {}

void FootHolder::restart() {
  std::ranges::fill(held_, HeldFoot());
  raise_ = 0.0;
}

void FootHolder::hold(std::span<const TrackedFoot> feet, double floor, const Eigen::Vector3d& path,
                      std::span<Pose> world_from_target) {
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const TrackedFoot& foot = feet[i];
    HeldFoot& held = held_[i];
    Eigen::Vector3d& target =
        world_from_target[static_cast<std::size_t>(foot.target())].translation;
    const double height = foot.sole_height() - floor;
    const double max_speed = held.on ? options_.contact_release_speed : options_.contact_speed;
    const double max_height =
        size_ * (held.on ? options_.contact_release_height : options_.contact_height);
    const bool was_on = held.on;
    held.on = foot.speed() < max_speed && std::abs(height) < max_height;
    const Eigen::Vector3d free = target + path;
    if (held.on && !was_on) held.place = free + held.shift;
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    if (held.on) {
      way = held.place - free;
      way.z() = -height;
      if (way.head<2>().norm() > kMaxShift) held.on = false;
    }
    // The shift moves exponentially towards the anchor, or towards zero.
    const double left = held.on ? ease_ : release_;
    held.shift = left * held.shift + (1.0 - left) * (held.on ? way : Eigen::Vector3d::Zero());
    const double length = held.shift.norm();
    if (length > kMaxShift) held.shift *= kMaxShift / length;
    target += held.shift;
    if (!held.on) {
      held.stood.reset();
      held.back *= release_;
    }
    target.head<2>() += held.back;
  }
}

// Integrates the slide of the sole into the target shift `back`, because the passes leave a
// residual error between target and sole.
void FootHolder::bring_back(const TrackedFoot& foot, HeldFoot& held) const {
  constexpr double kGain = 0.5;  // Share of the slide that is corrected per frame.
  const FitFoot& sole = model_.feet[static_cast<std::size_t>(foot.foot())];
  const Pose& world = pose_.world_from_link[static_cast<std::size_t>(sole.link)];
  const Eigen::Vector2d now =
      0.5 * (world * sole.ends[0].middle + world * sole.ends[1].middle).head<2>();
  if (!held.stood) held.stood = now;
  held.back += kGain * (*held.stood - now);
  const double length = held.back.norm();
  if (length > kMaxShift) held.back *= kMaxShift / length;
}

void FootHolder::stand(std::span<const TrackedFoot> feet, std::span<double> qpos) {
  pose_.update(qpos);
  double gap = HUGE_VAL;  // Height of the lowest stance sole above the floor, metres.
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (!held_[i].on) continue;
    bring_back(feet[i], held_[i]);
    const FitFoot& foot = model_.feet[static_cast<std::size_t>(feet[i].foot())];
    for (const FitFoot::End& end : foot.ends) {
      for (const Eigen::Vector3d& point : end.points) {
        const Pose& world = pose_.world_from_link[static_cast<std::size_t>(foot.link)];
        gap = std::min(gap, (world * point).z());
      }
    }
  }
  const double wanted = gap == HUGE_VAL ? 0.0 : std::clamp(-gap, -kMaxShift, kMaxShift);
  raise_ = settle_ * raise_ + (1.0 - settle_) * wanted;
  // Corrects penetration immediately, without the time constant.
  for (Pose& link : pose_.world_from_link) link.translation.z() += raise_;
  qpos[2] += raise_ - lowest_below_floor(model_, pose_);
}

}  // namespace retarget
