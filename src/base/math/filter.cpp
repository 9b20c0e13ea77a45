#include "retarget/filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Parameters of the anti-aliasing filter, relative to the output rate.
constexpr double kCutoff = 0.4;
constexpr double kHalfWidth = 6.0;
constexpr double kMaxHalfWidth = 1024.0;

// A filtered quaternion shorter than this has no defined direction.
constexpr double kMinNorm = 1e-6;

// Modified Bessel function of the first kind and order zero, by its power series.
double bessel_i0(double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= (0.5 * x / k) * (0.5 * x / k);
    sum += term;
  }
  return sum;
}

double sinc(double x) {
  const double angle = std::numbers::pi * x;
  return x == 0.0 ? 1.0 : portable::sin_cos(angle).sine / angle;
}

Eigen::Vector3d reflect(const Eigen::Vector3d& center, const Eigen::Vector3d& point) {
  return 2.0 * center - point;
}

Eigen::Quaterniond reflect(const Eigen::Quaterniond& center, const Eigen::Quaterniond& rotation) {
  return center * rotation.conjugate() * center;
}

// Extends a non-empty track by `margin` samples at each end.
template <typename Sample>
std::vector<Sample> extend(std::span<const Sample> track, int margin) {
  const int count = static_cast<int>(track.size());
  std::vector<Sample> extended(track.size() + 2 * static_cast<std::size_t>(margin), track[0]);
  if (count == 1) return extended;
  std::copy(track.begin(), track.end(), extended.begin() + margin);
  // Extends both ends outwards in step, so that the reflected sample is always already filled.
  const int first = margin;
  const int last = margin + count - 1;
  for (int k = 1; k <= margin; ++k) {
    extended[first - k] = reflect(extended[first], extended[first + k]);
    extended[last + k] = reflect(extended[last], extended[last - k]);
  }
  return extended;
}

// Weighted sum of neighbours; `middle` points into an extended track of vectors. Adding each pair
// before weighting it keeps a ramp exact to the last digits.
template <typename Vector>
Vector weigh(const Vector* middle, std::span<const double> taps) {
  const auto half = static_cast<std::ptrdiff_t>(taps.size() / 2);
  Vector sum = taps[half] * *middle;
  for (std::ptrdiff_t k = 1; k <= half; ++k) sum += taps[half + k] * (middle[-k] + middle[k]);
  return sum;
}

}  // namespace

std::vector<double> design_low_pass(double cutoff, int half_width, double beta) {
  std::vector<double> taps(2 * static_cast<std::size_t>(half_width) + 1);
  for (int k = 0; k <= half_width; ++k) {
    const double place = half_width > 0 ? static_cast<double>(k) / half_width : 0.0;
    const double window = bessel_i0(beta * std::sqrt(1.0 - place * place));
    const double tap = sinc(2.0 * cutoff * k) * window;
    taps[half_width + k] = taps[half_width - k] = tap;
  }
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  for (double& tap : taps) tap /= sum;
  return taps;
}

std::vector<double> anti_alias_taps(double ratio) {
  const double half_width = std::min(std::round(kHalfWidth * ratio), kMaxHalfWidth);
  return design_low_pass(kCutoff / ratio, static_cast<int>(half_width));
}

std::vector<Eigen::Vector3d> low_pass(std::span<const Eigen::Vector3d> points,
                                      std::span<const double> taps, std::size_t stride) {
  if (points.empty()) return {};
  const int half = static_cast<int>(taps.size() / 2);
  const auto extended = extend(points, half);
  std::vector<Eigen::Vector3d> filtered;
  filtered.reserve((points.size() - 1) / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    filtered.push_back(weigh(extended.data() + half + i, taps));
  }
  return filtered;
}

std::vector<Eigen::Quaterniond> low_pass(std::span<const Eigen::Quaterniond> rotations,
                                         std::span<const double> taps, std::size_t stride) {
  if (rotations.empty()) return {};
  const int half = static_cast<int>(taps.size() / 2);
  std::vector<Eigen::Vector4d> extended;
  extended.reserve(rotations.size() + taps.size());
  for (const auto& rotation : extend(rotations, half)) extended.push_back(rotation.coeffs());
  std::vector<Eigen::Quaterniond> filtered;
  filtered.reserve((rotations.size() - 1) / stride + 1);
  for (std::size_t i = 0; i < rotations.size(); i += stride) {
    const Eigen::Vector4d sum = weigh(extended.data() + half + i, taps);
    const double norm = sum.norm();
    filtered.push_back(rotations[i]);
    if (norm > kMinNorm) filtered.back().coeffs() = sum / norm;
  }
  return filtered;
}

}  // namespace retarget
