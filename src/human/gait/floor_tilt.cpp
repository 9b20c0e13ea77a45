#include "human/gait/floor_tilt.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kTiltInterval = 0.1;  // Seconds between samples.
constexpr int kMostTiltSamples = 1000;
constexpr double kStandingToe = 0.15;                          // m/s
constexpr double kLeastTilt = 8.0 * std::numbers::pi / 180.0;  // rad
constexpr double kTiltAgreement = 0.6;                         // Share of the tilt.
constexpr std::size_t kLeastPoints = 20;
// Root mean squares of the distances to the plane and within it, metres.
constexpr double kPlaneResidual = 0.03, kNarrowSpread = 0.05, kWideSpread = 0.3;

constexpr std::array kTiltToes = {Bone::kLeftToe, Bone::kRightToe};

// Standing toes and the mean direction of the trunk.
struct Samples {
  std::vector<Vector3d> toes;
  Vector3d trunk = Vector3d::Zero();
};

Samples sample(HumanPoser& poser, FrameRange part, const FrameRate& rate) {
  Samples samples;
  HumanPose before, after;
  const int step = std::max({1, static_cast<int>(std::lround(kTiltInterval / rate.frame_time())),
                             (part.end - part.begin) / kMostTiltSamples});
  for (int frame = part.begin; frame + 1 < part.end; frame += step) {
    poser.pose(frame, before);
    poser.pose(frame + 1, after);
    const Vector3d line = before[Bone::kNeck].translation - before[Bone::kHips].translation;
    if (line.norm() > 0.0) samples.trunk += line.normalized();
    for (const Bone toe : kTiltToes) {
      const Vector3d& place = before[toe].translation;
      const double moved = (after[toe].translation - place).norm();
      if (moved < kStandingToe * rate.frame_time()) samples.toes.push_back(place);
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

}  // namespace

std::optional<FloorTilt> find_floor_tilt(HumanPoser& poser, FrameRange part) {
  const HumanClipInfo info = poser.info();
  for (const Bone bone : {Bone::kHips, Bone::kNeck, kTiltToes[0], kTiltToes[1]}) {
    if (!info.has(bone)) return std::nullopt;
  }
  const Samples samples = sample(poser, part, info.rate);
  const auto normal = normal_of(samples.toes);
  if (!normal || !(samples.trunk.norm() > 0.0)) return std::nullopt;
  const Vector3d trunk = samples.trunk.normalized(), up = Vector3d::UnitZ();
  const double tilt = angle_between(*normal, up);
  if (!(tilt > kLeastTilt && angle_between(trunk, up) > kLeastTilt)) return std::nullopt;
  if (!(angle_between(trunk, *normal) < kTiltAgreement * tilt)) return std::nullopt;
  return FloorTilt{*normal, tilt};
}

}  // namespace retarget
