#include "human/gait/standing_balance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "human/gait/frame_runs.h"
#include "human/skeleton/body_masses.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kBalanceInterval = 0.1;  // Seconds between samples, and for speeds.
constexpr int kMostBalanceSamples = 1000;
constexpr std::size_t kLeastBalanceSamples = 12;
constexpr double kBalancedFoot = 0.15, kBalancedHips = 0.3;  // m/s
constexpr double kStraightLeg = 0.93;                        // Of thigh and shin.
constexpr double kBalanceDegree = std::numbers::pi / 180.0;
constexpr double kSway = 8.0 * kBalanceDegree;
constexpr double kFlattest = 8.0 * kBalanceDegree,
                 kSteepest = 40.0 * kBalanceDegree;  // Slopes of standing feet.

class BalanceSamples {
 public:
  explicit BalanceSamples(const HumanClipInfo& info) : info_(info) {}

  void add(const HumanPose& pose, const HumanPose& later, double seconds) {
    Vector3d feet = Vector3d::Zero(), forward = Vector3d::Zero();
    int ends = 0;
    const auto is_still = [&](Bone bone, double speed) {
      return (later[bone].translation - pose[bone].translation).norm() < speed * seconds;
    };
    if (!is_still(Bone::kHips, kBalancedHips)) return;
    for (const Side side : kSides) {
      const auto bone = [side](LimbBone part) { return side_bone(side, part); };
      const Bone ankle = bone(LimbBone::kFoot), toe = bone(LimbBone::kToe);
      if (!is_straight(pose, side) || !is_still(ankle, kBalancedFoot)) return;
      feet += pose[ankle].translation;
      ++ends;
      if (!info_.has(toe)) continue;
      if (!is_still(toe, kBalancedFoot)) return;
      feet += pose[toe].translation;
      ++ends;
      forward += (pose[toe].translation - pose[ankle].translation).normalized();
    }
    const auto [sum, mass] =
        weighted_positions([&](Bone bone) { return info_.has(bone); },
                           [&](Bone bone) -> const Vector3d& { return pose[bone].translation; });
    const Vector3d up = sum / mass - feet / ends;
    ups_.push_back(up.normalized());
    forward_ += forward;
  }

  [[nodiscard]] std::optional<Vector3d> direction() const {
    if (ups_.size() < kLeastBalanceSamples) return std::nullopt;
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& up : ups_) sum += up;
    if (!(sum.norm() > 0.0)) return std::nullopt;
    const Vector3d mean = sum.normalized();
    std::vector<double> angles;
    for (const Vector3d& up : ups_) angles.push_back(angle_between(up, mean));
    if (percentile(std::move(angles), 90.0) > kSway || !has_standing_slope(mean)) {
      return std::nullopt;
    }
    return mean;
  }

 private:
  [[nodiscard]] static bool is_straight(const HumanPose& pose, Side side) {
    const auto place = [&](LimbBone part) { return pose[side_bone(side, part)].translation; };
    const Vector3d hip = place(LimbBone::kUpLeg), knee = place(LimbBone::kLeg);
    const Vector3d ankle = place(LimbBone::kFoot);
    const double leg = (knee - hip).norm() + (ankle - knee).norm();
    return (ankle - hip).norm() > kStraightLeg * leg;
  }

  // A body that leans on something is tilted, but not its feet. Without toes, this is unknown.
  [[nodiscard]] bool has_standing_slope(const Vector3d& up) const {
    if (!(forward_.norm() > 0.0)) return true;
    const double slope = angle_between(forward_.normalized(), up) - 0.5 * std::numbers::pi;
    return slope > kFlattest && slope < kSteepest;
  }

  const HumanClipInfo& info_;
  std::vector<Vector3d> ups_;
  Vector3d forward_ = Vector3d::Zero();
};

bool has_body(const HumanClipInfo& info) {
  if (!info.has(Bone::kHips) || !info.has(Bone::kHead)) return false;
  return std::ranges::all_of(kSides, [&](Side side) {
    return info.has(side_bone(side, LimbBone::kUpLeg)) &&
           info.has(side_bone(side, LimbBone::kLeg)) && info.has(side_bone(side, LimbBone::kFoot));
  });
}

}  // namespace

std::optional<Vector3d> find_balance(HumanPoser& poser, FrameRange part) {
  const HumanClipInfo info = poser.info();
  if (!has_body(info)) return std::nullopt;
  const int interval = frames_in(kBalanceInterval, info.rate.frame_time());
  const int step = std::max(interval, (part.end - part.begin) / kMostBalanceSamples);
  BalanceSamples samples(info);
  HumanPose pose, later;
  for (int frame = part.begin; frame + interval < part.end; frame += step) {
    poser.pose(frame, pose);
    poser.pose(frame + interval, later);
    samples.add(pose, later, interval * info.rate.frame_time());
  }
  return samples.direction();
}

}  // namespace retarget
