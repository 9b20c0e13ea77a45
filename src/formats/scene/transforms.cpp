#include "formats/scene/transforms.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

// Half a turn about the axis with positive scale, if the two others are negative.
Eigen::Quaterniond turned_over(const Eigen::Vector3d& scale) {
  const bool x = scale.x() < 0.0, y = scale.y() < 0.0, z = scale.z() < 0.0;
  if (y && z) return {0.0, 1.0, 0.0, 0.0};
  if (x && z) return {0.0, 0.0, 1.0, 0.0};
  if (x && y) return {0.0, 0.0, 0.0, 1.0};
  return Eigen::Quaterniond::Identity();
}

}  // namespace

NodePlace place_below(const NodePlace& parent, const NodeTransform& parent_from_node) {
  const auto& [translation, rotation, scale] = parent_from_node;
  NodePlace place;
  place.world_from_node.linear() = parent.world_from_node.linear() *
                                   rotation.normalized().toRotationMatrix() * scale.asDiagonal();
  place.world_from_node.translation() = parent.world_from_node * translation;
  place.rotation = (parent.rotation * rotation * turned_over(scale)).normalized();
  return place;
}

bool is_mirrored(const NodeTransform& transform) {
  int negative = 0;
  for (const double scale : transform.scale) negative += scale < 0.0 ? 1 : 0;
  return negative % 2 == 1;
}

bool is_sound(const NodeTransform& transform) {
  // Also excludes numbers whose squares overflow.
  constexpr double kLargest = 1e100;
  const double norm = transform.rotation.coeffs().squaredNorm();
  return transform.translation.cwiseAbs().maxCoeff() < kLargest &&
         transform.scale.cwiseAbs().maxCoeff() < kLargest && transform.translation.allFinite() &&
         transform.scale.allFinite() && norm > 1e-6 && norm < 1e6;
}

Eigen::Quaterniond rotation_of(const Eigen::Matrix3d& matrix) {
  Eigen::Matrix3d axes;
  axes.col(0) = matrix.col(0).stableNormalized();
  axes.col(2) = axes.col(0).cross(matrix.col(1)).stableNormalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Eigen::Quaterniond(axes).normalized();
}

NodeTransform decomposed(const Eigen::Affine3d& affine) {
  const Eigen::Matrix3d& linear = affine.linear();
  NodeTransform result;
  result.translation = affine.translation();
  result.rotation = rotation_of(linear);
  for (int axis = 0; axis < 3; ++axis) result.scale[axis] = linear.col(axis).stableNorm();
  if (linear.determinant() < 0.0) result.scale.z() = -result.scale.z();
  return result;
}

std::optional<Eigen::Affine3d> usable_bind(const Eigen::Affine3d& affine) {
  const double volume = affine.linear().determinant();
  const bool is_finite = affine.matrix().allFinite() && std::isfinite(volume);
  if (!is_finite || !(volume > 1e-18) || affine.matrix().cwiseAbs().maxCoeff() > 1e9) {
    return std::nullopt;
  }
  return affine;
}

namespace {

constexpr double kMinRate = 12.0, kMaxRate = 1000.0;
constexpr std::size_t kMinKeys = 3;
// Seconds; files store times as floats or in ticks.
constexpr double kEqual = 2e-5;
// In frames.
constexpr double kMaxOff = 0.02;

}  // namespace

std::optional<double> rate_of_keys(std::vector<double> times) {
  std::erase_if(times, [](double time) { return !std::isfinite(time); });
  std::ranges::sort(times);
  const auto same = [](double a, double b) { return b - a < kEqual; };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
  if (times.size() < kMinKeys) return std::nullopt;
  double gap = times[1] - times[0];
  for (std::size_t i = 2; i < times.size(); ++i) gap = std::min(gap, times[i] - times[i - 1]);
  // Refine the rate of the smallest gap over the whole duration.
  const double length = times.back() - times.front();
  const double frames = std::round(length / gap);
  if (!(frames >= 1.0) || frames > 1e8) return std::nullopt;
  const double rate = frames / length;
  if (rate < kMinRate || rate > kMaxRate) return std::nullopt;
  for (const double time : times) {
    const double frame = (time - times.front()) * rate;
    if (std::abs(frame - std::round(frame)) > kMaxOff) return std::nullopt;
  }
  return rate;
}

}  // namespace retarget
