#include "human/gait/floor_tilt.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "human/gait/standing_balance.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kTiltInterval = 0.1;  // Seconds between samples.
constexpr int kMostTiltSamples = 1000;
constexpr double kStandingFoot = 0.15;                         // m/s
constexpr double kStillFor = 0.1;                              // Seconds, for the speed of a foot.
constexpr double kLeastTilt = 8.0 * std::numbers::pi / 180.0;  // rad
constexpr double kLeastLean = 12.0 * std::numbers::pi / 180.0;
constexpr double kMostLean = 45.0 * std::numbers::pi / 180.0;  // More is another up axis.
constexpr double kTiltAgreement = 0.6;                         // Share of the tilt.
constexpr std::size_t kLeastPoints = 20;
// Root mean squares of the distances to the plane and within it, metres.
constexpr double kPlaneResidual = 0.03, kNarrowSpread = 0.05, kWideSpread = 0.3;

// Standing feet and the mean direction of the trunk.
struct Samples {
  std::vector<Vector3d> feet;
  Vector3d trunk = Vector3d::Zero();
};

// The joints of both sides that stand: toes or, in sources without toes, ankles.
std::optional<std::array<Bone, 2>> standing_joints(const HumanClipInfo& info) {
  for (const LimbBone part : {LimbBone::kToe, LimbBone::kFoot}) {
    const std::array both = {side_bone(Side::kLeft, part), side_bone(Side::kRight, part)};
    if (info.has(both[0]) && info.has(both[1])) return both;
  }
  return std::nullopt;
}

Samples sample(HumanPoser& poser, const std::array<Bone, 2>& feet, FrameRange part,
               const FrameRate& rate) {
  const auto frames_in = [&](double seconds) {
    return std::max(1, static_cast<int>(std::lround(seconds / rate.frame_time())));
  };
  Samples samples;
  HumanPose before, after;
  const int still = frames_in(kStillFor);
  const int step = std::max(frames_in(kTiltInterval), (part.end - part.begin) / kMostTiltSamples);
  for (int frame = part.begin; frame + still < part.end; frame += step) {
    poser.pose(frame, before);
    poser.pose(frame + still, after);
    const Vector3d line = before[Bone::kNeck].translation - before[Bone::kHips].translation;
    if (line.norm() > 0.0) samples.trunk += line.normalized();
    for (const Bone foot : feet) {
      const Vector3d &place = before[foot].translation, &later = after[foot].translation;
      const double moved = (later - place).norm();
      if (moved < kStandingFoot * still * rate.frame_time()) {
        samples.feet.push_back(0.5 * (place + later));
      }
    }
  }
  return samples;
}

// Normal of the plane of the points; empty if they do not fit a plane or lie on a line.
std::optional<Vector3d> normal_of(const std::vector<Vector3d>& points) {
  if (points.size() < kLeastPoints) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point / count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3d& point : points) {
    covariance += (point - mean) * (point - mean).transpose() / count;
  }
  // In ascending order.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const Vector3d spread = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (!(spread[0] < kPlaneResidual && spread[1] > kNarrowSpread && spread[2] > kWideSpread)) {
    return std::nullopt;
  }
  const Vector3d normal = axes.eigenvectors().col(0);
  return normal.z() < 0.0 ? Vector3d(-normal) : normal;
}

// The tilt of the floor on which toes stand, if the trunk leans alike.
std::optional<FloorTilt> tilt_of_floor(HumanPoser& poser, FrameRange part) {
  const HumanClipInfo info = poser.info();
  const auto feet = standing_joints(info);
  if (!feet || !info.has(Bone::kHips) || !info.has(Bone::kNeck)) return std::nullopt;
  const Samples samples = sample(poser, *feet, part, info.rate);
  const auto normal = normal_of(samples.feet);
  if (!normal || !(samples.trunk.norm() > 0.0)) return std::nullopt;
  const Vector3d trunk = samples.trunk.normalized(), up = Vector3d::UnitZ();
  const double tilt = angle_between(*normal, up);
  if (!(tilt > kLeastTilt && angle_between(trunk, up) > kLeastTilt)) return std::nullopt;
  if (!(angle_between(trunk, *normal) < kTiltAgreement * tilt)) return std::nullopt;
  return FloorTilt{*normal, tilt, false};
}

}  // namespace

std::optional<FloorTilt> find_floor_tilt(HumanPoser& poser, FrameRange part) {
  if (const auto tilt = tilt_of_floor(poser, part)) return tilt;
  // Standing on one spot does not show a plane, but a body that does not fall is balanced.
  const auto balance = find_balance(poser, part);
  if (!balance) return std::nullopt;
  const double tilt = angle_between(*balance, Vector3d::UnitZ());
  if (!(tilt > kLeastLean && tilt < kMostLean)) return std::nullopt;
  return FloorTilt{*balance, tilt, true};
}

}  // namespace retarget
