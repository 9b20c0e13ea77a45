#include "solve/online/floor_finder.h"

#include <algorithm>
#include <cmath>

#include "human/gait/source_feet.h"
#include "solve/fit/fit_setup.h"

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
    : max_speed_(options.contact_speed) {
  constexpr double kFloorSpeed = 0.1;  // m/s
  step_ = kFloorSpeed * frame_time;
}

void FloorFinder::restart() {
  count_ = 0;
  wait_ = 0;
  begun_ = false;
}

// Median height of the stances on the lowest level.
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

double FloorFinder::add(std::span<const TrackedFoot> feet) {
  constexpr int kWait = 8;         // Frames between two estimates.
  constexpr double kStands = 0.5;  // Minimum TrackedFoot::up of a stance.
  if (feet.empty()) return 0.0;
  double lowest = HUGE_VAL;
  bool stands = false;
  for (const TrackedFoot& foot : feet) {
    lowest = std::min(lowest, foot.sole_height());
    if (foot.speed() > max_speed_ || foot.up() < kStands) continue;
    heights_[count_++ % heights_.size()] = foot.sole_height();
    stands = true;
  }
  if (!begun_) {
    begun_ = true;
    floor_ = goal_ = lowest;
  }
  if (stands && wait_-- <= 0) {
    wait_ = kWait;
    goal_ = estimate();
  }
  floor_ += std::clamp(goal_ - floor_, -step_, step_);
  return floor_;
}

}  // namespace retarget
