#include "solve/online/foot_holder.h"

#include <algorithm>
#include <cmath>

#include "human/gait/source_feet.h"
#include "solve/fit/start_frames.h"

namespace retarget {
namespace {

constexpr double kMaxShift = 0.03;  // Metres; a foot shifted farther is released.
// Time constants, seconds: applying a shift, releasing it, and moving the root to the floor.
constexpr double kEaseTime = 0.04, kReleaseTime = 0.1, kSettleTime = 0.08;

// Fraction of a distance that remains after one frame, for a given time constant.
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
    // Ease towards the anchor, or back to no shift.
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

// The passes leave a residual error, so shift the target beyond the anchor to bring the sole to it.
void FootHolder::bring_back(const TrackedFoot& foot, HeldFoot& held) const {
  constexpr double kGain = 0.5;  // Fraction of the sole's offset.
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
  // Correct penetration at once.
  for (Pose& link : pose_.world_from_link) link.translation.z() += raise_;
  qpos[2] += raise_ - lowest_below_floor(model_, pose_);
}

}  // namespace retarget
