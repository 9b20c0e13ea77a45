#include "retarget/ground_path.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Subdivisions of a segment whose arc lengths are stored.
constexpr int kParts = 16;
// Distance from a cusp, as a fraction of a segment, at which the tangent is evaluated instead.
constexpr double kBesideCusp = 1e-4;

// Five-point Gauss-Legendre quadrature on [-1, 1].
constexpr std::array<std::pair<double, double>, 5> kGauss = {
    {{-0.9061798459386640, 0.2369268850561891},
     {-0.5384693101056831, 0.4786286704993665},
     {0.0, 0.5688888888888889},
     {0.5384693101056831, 0.4786286704993665},
     {0.9061798459386640, 0.2369268850561891}}};

double heading_of(const Eigen::Vector2d& direction) {
  return portable::atan2(direction.y(), direction.x());
}

}  // namespace

GroundPath::GroundPath(std::vector<Eigen::Vector2d> control_points)
    : points_(std::move(control_points)), lengths_{0.0} {
  assert(points_.size() >= 4 && points_.size() % 3 == 1);
  for (std::size_t segment = 0; segment < segment_count(); ++segment) {
    for (int part = 0; part < kParts; ++part) {
      const double from = static_cast<double>(part) / kParts;
      const double to = static_cast<double>(part + 1) / kParts;
      lengths_.push_back(lengths_.back() + length_between(segment, from, to));
    }
  }
}

Eigen::Vector2d GroundPath::point(std::size_t segment, double u) const {
  const Eigen::Vector2d* p = &points_[3 * segment];
  const double v = 1.0 - u;
  return v * v * v * p[0] + 3.0 * v * v * u * p[1] + 3.0 * v * u * u * p[2] + u * u * u * p[3];
}

Eigen::Vector2d GroundPath::derivative(std::size_t segment, double u) const {
  const Eigen::Vector2d* p = &points_[3 * segment];
  const double v = 1.0 - u;
  return 3.0 * (v * v * (p[1] - p[0]) + 2.0 * v * u * (p[2] - p[1]) + u * u * (p[3] - p[2]));
}

Eigen::Vector2d GroundPath::direction(std::size_t segment, double u) const {
  const Eigen::Vector2d* p = &points_[3 * segment];
  const double size = (p[1] - p[0]).norm() + (p[2] - p[1]).norm() + (p[3] - p[2]).norm();
  constexpr double kVanishes = 1e-9;
  Eigen::Vector2d result = derivative(segment, u);
  if (result.norm() <= kVanishes * size) {
    result = derivative(segment, u < 0.5 ? u + kBesideCusp : u - kBesideCusp);
  }
  return result;
}

double GroundPath::length_between(std::size_t segment, double from, double to) const {
  const double half = 0.5 * (to - from), middle = 0.5 * (to + from);
  double sum = 0.0;
  for (const auto& [node, weight] : kGauss) {
    sum += weight * derivative(segment, middle + half * node).norm();
  }
  return half * sum;
}

double GroundPath::length_to(std::size_t segment, double u) const {
  const int part = std::clamp(static_cast<int>(u * kParts), 0, kParts - 1);
  return lengths_[segment * kParts + static_cast<std::size_t>(part)] +
         length_between(segment, static_cast<double>(part) / kParts, u);
}

GroundPose GroundPath::straight_on(std::size_t segment, double u, double beyond) const {
  const Eigen::Vector2d tangent = direction(segment, u);
  const Eigen::Vector2d place = point(segment, u);
  if (tangent.isZero(0.0)) return {place, 0.0};
  return {place + beyond * tangent.normalized(), heading_of(tangent)};
}

GroundPose GroundPath::at(double along) const {
  // Find the part around the length; parts of zero length are skipped.
  const auto after = std::ranges::upper_bound(lengths_, std::max(along, 0.0));
  if (after == lengths_.end()) {
    // Extrapolate from the last part with nonzero length.
    const auto end = std::ranges::lower_bound(lengths_, length());
    const auto part =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(end - lengths_.begin() - 1, 0));
    const std::size_t segment = part / kParts;
    const double u = static_cast<double>(part % kParts + 1) / kParts;
    return straight_on(segment, u, along - length());
  }
  const auto part = static_cast<std::size_t>(after - lengths_.begin() - 1);
  const std::size_t segment = part / kParts;
  const double begin = static_cast<double>(part % kParts) / kParts;
  if (along <= 0.0) return straight_on(segment, begin, along);

  // Newton's method, safeguarded by bisection within the part.
  const double wanted = along - lengths_[part];
  double low = begin, high = begin + 1.0 / kParts;
  double u = begin + wanted / (*after - lengths_[part]) / kParts;
  constexpr double kClose = 1e-15;
  for (int round = 0; round < 40; ++round) {
    const double miss = length_between(segment, begin, u) - wanted;
    (miss > 0.0 ? high : low) = u;
    const double speed = derivative(segment, u).norm();
    double next = speed > 0.0 ? u - miss / speed : 0.5 * (low + high);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool close = std::abs(next - u) <= kClose;
    u = next;
    if (close) break;
  }
  return straight_on(segment, u, 0.0);
}

GroundPath GroundPath::moved(const GroundPose& move) const {
  std::vector<Eigen::Vector2d> points;
  points.reserve(points_.size());
  for (const Eigen::Vector2d& point : points_) points.push_back(move * point);
  return GroundPath(std::move(points));
}

GroundPath GroundPath::scaled(double scale) const {
  std::vector<Eigen::Vector2d> points;
  points.reserve(points_.size());
  for (const Eigen::Vector2d& point : points_) {
    points.push_back(points_.front() + scale * (point - points_.front()));
  }
  return GroundPath(std::move(points));
}

}  // namespace retarget
