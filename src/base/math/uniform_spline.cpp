#include "base/math/uniform_spline.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "retarget/so3.h"
#include "retarget/spline.h"

namespace retarget {
namespace {

// The spline's corrected extremes stay this far inside the bounds, relative to their scale, so that
// rounding does not matter.
constexpr double kInside = 1e-9;
// Excess that ends the correction, relative likewise.
constexpr double kEnough = 1e-12;
constexpr int kMaxRounds = 2000;
// Rounded samples may exceed a bound by this share of it.
constexpr double kRounding = 1e-6;
// Pieces within this distance of a sample beyond a bound are not bounded, because the spline
// oscillates around such samples.
constexpr int kSwings = 2;

// Weights of the four coefficients of a segment in its value.
std::array<double, 4> value_weights(double s) {
  const double r = 1.0 - s;
  return {r * r * r / 6.0, (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
          (4.0 - 6.0 * r * r + 3.0 * r * r * r) / 6.0, s * s * s / 6.0};
}

// The same for its velocity.
std::array<double, 4> velocity_weights(double s) {
  const double r = 1.0 - s;
  return {-r * r / 2.0, (3.0 * s * s - 4.0 * s) / 2.0, (4.0 * r - 3.0 * r * r) / 2.0, s * s / 2.0};
}

}  // namespace

UniformCubic::UniformCubic(const double* q)
    : a((q[0] + 4.0 * q[1] + q[2]) / 6.0),
      b((q[2] - q[0]) / 2.0),
      c((q[0] - 2.0 * q[1] + q[2]) / 2.0),
      d((q[3] - q[0] + 3.0 * (q[1] - q[2])) / 6.0) {}

struct UniformSpline::PieceBounds {
  double lower, upper, speed;
};

UniformSpline::UniformSpline(std::span<const double> samples) {
  const std::size_t count = samples.size();
  if (count < 2) {
    coefficients_.assign(4, samples[0]);
    return;
  }
  std::vector<Eigen::Vector3d> points;
  for (const double sample : samples) points.emplace_back(sample, 0.0, 0.0);
  const std::vector<Eigen::Vector3d> velocities = spline_velocities(steps_between(points));
  // Half the second derivative at the beginning of a segment, from the values and velocities at its
  // ends, gives the coefficient of its first sample.
  coefficients_.resize(count + 2);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const double bend =
        6.0 * (samples[i + 1] - samples[i]) - 4.0 * velocities[i].x() - 2.0 * velocities[i + 1].x();
    coefficients_[i + 1] = samples[i] - bend / 6.0;
  }
  const std::size_t last = count - 1;
  const double bend = -6.0 * (samples[last] - samples[last - 1]) + 2.0 * velocities[last - 1].x() +
                      4.0 * velocities[last].x();
  coefficients_[count] = samples[last] - bend / 6.0;
  coefficients_[0] = coefficients_[2] - 2.0 * velocities[0].x();
  coefficients_[count + 1] = coefficients_[count - 1] + 2.0 * velocities[last].x();
}

SplineState UniformSpline::at(int piece, double s) const {
  const UniformCubic p = cubic(piece);
  return {p.value(s), p.velocity(s), 2.0 * p.c + 6.0 * s * p.d};
}

UniformSpline::Range UniformSpline::values(int piece) const {
  const UniformCubic p = cubic(piece);
  Range range{{p.value(0.0), static_cast<double>(piece)},
              {p.value(0.0), static_cast<double>(piece)}};
  const auto take = [&](double s) {
    if (!(s > 0.0 && s <= 1.0)) return;
    const SplineExtreme here{p.value(s), piece + s};
    if (here.value < range.least.value) range.least = here;
    if (here.value > range.greatest.value) range.greatest = here;
  };
  take(1.0);
  // Roots of b + 2 c s + 3 d s^2, in the form without cancellation.
  const double root = p.c * p.c - 3.0 * p.d * p.b;
  if (root >= 0.0) {
    const double sum = -(p.c + std::copysign(std::sqrt(root), p.c));
    if (p.d != 0.0) take(sum / (3.0 * p.d));
    if (sum != 0.0) take(p.b / sum);
  }
  return range;
}

UniformSpline::Range UniformSpline::velocities(int piece) const {
  const UniformCubic p = cubic(piece);
  Range range{{p.b, static_cast<double>(piece)}, {p.b, static_cast<double>(piece)}};
  for (const double s : {1.0, p.d != 0.0 ? -p.c / (3.0 * p.d) : 1.0}) {
    if (!(s > 0.0 && s <= 1.0)) continue;
    const SplineExtreme here{p.velocity(s), piece + s};
    if (here.value < range.least.value) range.least = here;
    if (here.value > range.greatest.value) range.greatest = here;
  }
  return range;
}

std::vector<UniformSpline::PieceBounds> UniformSpline::piece_bounds(
    const SplineBounds& bounds) const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double slack = kRounding * (bounds.upper - bounds.lower);
  std::vector<PieceBounds> all;
  std::vector<int> beyond_place, beyond_speed;
  for (int i = 0; i < piece_count(); ++i) {
    const UniformCubic p = cubic(i);
    const double from = p.a, to = p.value(1.0);
    const double low = std::min(from, to), high = std::max(from, to);
    all.push_back({std::min(bounds.lower, low), std::max(bounds.upper, high),
                   std::max(bounds.speed, high - low)});
    if (low < bounds.lower - slack || high > bounds.upper + slack) beyond_place.push_back(i);
    if (high - low > (1.0 + kRounding) * bounds.speed) beyond_speed.push_back(i);
  }
  const auto near = [&](int i, const auto& release) {
    for (int k = std::max(0, i - kSwings); k <= std::min(piece_count() - 1, i + kSwings); ++k) {
      release(all[static_cast<std::size_t>(k)]);
    }
  };
  for (const int i : beyond_place) {
    near(i, [](PieceBounds& piece) { piece.lower = -(piece.upper = kNone); });
  }
  for (const int i : beyond_speed) near(i, [](PieceBounds& piece) { piece.speed = kNone; });
  return all;
}

void UniformSpline::move(int piece, double s, bool velocity, double change) {
  const std::array<double, 4> weights = velocity ? velocity_weights(s) : value_weights(s);
  double square = 0.0;
  for (const double weight : weights) square += weight * weight;
  for (std::size_t k = 0; k < 4; ++k) {
    coefficients_[static_cast<std::size_t>(piece) + k] += change * weights[k] / square;
  }
}

// Projects the coefficients of a segment. Returns how far it was outside, relative to the scales.
double UniformSpline::correct(int piece, const PieceBounds& bounds) {
  double worst = 0.0;
  const double width = bounds.upper - bounds.lower;
  if (std::isfinite(width) && width > 0.0) {
    const double margin = kInside * width;
    const Range range = values(piece);
    if (const double over = range.greatest.value - bounds.upper; over > 0.0) {
      worst = std::max(worst, over / width);
      move(piece, range.greatest.at - piece, false, -(over + margin));
    }
    if (const double under = bounds.lower - range.least.value; under > 0.0) {
      worst = std::max(worst, under / width);
      move(piece, range.least.at - piece, false, under + margin);
    }
  }
  if (std::isfinite(bounds.speed) && bounds.speed > 0.0) {
    const double margin = kInside * bounds.speed;
    const Range range = velocities(piece);
    if (const double over = range.greatest.value - bounds.speed; over > 0.0) {
      worst = std::max(worst, over / bounds.speed);
      move(piece, range.greatest.at - piece, true, -(over + margin));
    }
    if (const double under = -bounds.speed - range.least.value; under > 0.0) {
      worst = std::max(worst, under / bounds.speed);
      move(piece, range.least.at - piece, true, under + margin);
    }
  }
  return worst;
}

SplineCorrection UniformSpline::keep_inside(const SplineBounds& bounds) {
  const std::vector<double> before = coefficients_;
  const std::vector<PieceBounds> pieces = piece_bounds(bounds);
  SplineCorrection correction;
  for (int round = 0; round < kMaxRounds; ++round) {
    correction.excess = 0.0;
    for (int i = 0; i < piece_count(); ++i) {
      correction.excess =
          std::max(correction.excess, correct(i, pieces[static_cast<std::size_t>(i)]));
    }
    if (correction.excess <= kEnough) break;
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    // The coefficients bound the spline, and differences of splines are splines.
    const double change = std::abs(coefficients_[i] - before[i]);
    if (change <= correction.largest) continue;
    correction.largest = change;
    correction.at =
        std::clamp(static_cast<double>(i) - 1.0, 0.0, static_cast<double>(piece_count()));
  }
  return correction;
}

using Eigen::Matrix3d;
using Eigen::Vector3d;

RotationSpline::RotationSpline(std::span<const Eigen::Quaterniond> rotations)
    : rotations_(rotations.begin(), rotations.end()) {
  for (std::size_t i = 1; i < rotations_.size(); ++i) {
    steps_.push_back(log_so3(rotations_[i - 1].conjugate() * rotations_[i]));
  }
  velocities_.assign(rotations_.size(), Vector3d::Zero());
  if (steps_.empty()) return;
  velocities_ = steps_;
  velocities_.push_back(steps_.back());
  if (steps_.size() > 1) {
    // End velocities of the parabola through the three samples there.
    const std::size_t last = steps_.size() - 1;
    velocities_.front() = 1.5 * steps_[0] - 0.5 * steps_[1];
    velocities_.back() = 1.5 * steps_[last] - 0.5 * steps_[last - 1];
  }
  solve();
}

// Solves for continuous acceleration at every inner sample i. The second derivatives of the cubic
// are 6 step - 4 v - 2 u at its beginning and -6 step + 2 v + 4 u at its end, where u = J^-1 v_next
// and J is the right Jacobian at the step:
//   2 J(step_{i-1}) v_{i-1} + 8 v_i + 2 J^-1(step_i) v_{i+1}
//       = 6 (step_{i-1} + step_i) - rate of J at the end of the previous segment.
void RotationSpline::solve() {
  constexpr int kMaxRounds = 20;
  constexpr double kTolerance = 1e-13;  // Radians per sample.
  const std::size_t last = velocities_.size() - 1;
  if (last < 2) return;
  std::vector<Matrix3d> upper(last), inverse_pivots(last);
  for (std::size_t i = 1; i < last; ++i) {
    Matrix3d pivot = 8.0 * Matrix3d::Identity();
    if (i > 1) pivot -= 2.0 * right_jacobian_so3(steps_[i - 1]) * upper[i - 1];
    inverse_pivots[i] = pivot.inverse();
    upper[i] = inverse_pivots[i] * (2.0 * left_jacobian_inverse_so3(-steps_[i]));
  }
  std::vector<Vector3d> solution(last);
  for (int round = 0; round < kMaxRounds; ++round) {
    for (std::size_t i = 1; i < last; ++i) {
      const Vector3d& before = steps_[i - 1];
      const Vector3d end_rate = apply_left_jacobian_inverse_so3(-before, velocities_[i]);
      Vector3d right = 6.0 * (before + steps_[i]) - right_jacobian_rate_so3(before, end_rate);
      right -= 2.0 * right_jacobian_so3(before) * (i > 1 ? solution[i - 1] : velocities_[0]);
      if (i + 1 == last) right -= 2.0 * left_jacobian_inverse_so3(-steps_[i]) * velocities_[last];
      solution[i] = inverse_pivots[i] * right;
    }
    double change = 0.0;
    for (std::size_t i = last; i-- > 1;) {
      if (i + 1 < last) solution[i] -= upper[i] * solution[i + 1];
      change = std::max(change, (solution[i] - velocities_[i]).cwiseAbs().maxCoeff());
      velocities_[i] = solution[i];
    }
    if (change < kTolerance) return;
  }
}

RotationState RotationSpline::at(int sample, double s) const {
  const auto i = static_cast<std::size_t>(sample);
  if (steps_.empty()) return {rotations_[0], Vector3d::Zero(), Vector3d::Zero()};
  const Vector3d &step = steps_[i], &v = velocities_[i];
  const Vector3d u = apply_left_jacobian_inverse_so3(-step, velocities_[i + 1]);
  // The cubic is v s + c s^2 + d s^3.
  const Vector3d c = 3.0 * step - 2.0 * v - u, d = v + u - 2.0 * step;
  const Vector3d theta = s * (v + s * (c + s * d));
  const Vector3d rate = v + s * (2.0 * c + 3.0 * s * d);
  const Vector3d second = 2.0 * c + 6.0 * s * d;
  const Matrix3d jacobian = right_jacobian_so3(theta);
  return {(rotations_[i] * exp_so3(theta)).normalized(), jacobian * rate,
          jacobian * second + right_jacobian_rate_so3(theta, rate)};
}

}  // namespace retarget
