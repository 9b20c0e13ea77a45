#include "math/rotation_spline.h"

#include <Eigen/LU>
#include <algorithm>

#include "math/se3.h"
#include "math/so3.h"
#include "math/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The right Jacobian is 1 - a [w] + b [w]^2; a = (1 - cos x) / x^2 and b = (x - sin x) / x^3 at the
// angle x, and what their rates are per w . dw/dt.
struct JacobianTerms {
  double a, b, a_rate, b_rate;
};

JacobianTerms jacobian_terms(double angle) {
  // below it the closed forms cancel, and the first terms left out are smaller than rounding
  constexpr double kSeriesBelow = 0.2;
  const double x2 = angle * angle, x4 = x2 * x2, x6 = x4 * x2;
  if (angle < kSeriesBelow) {
    return {1.0 / 2.0 - x2 / 24.0 + x4 / 720.0 - x6 / 40320.0,
            1.0 / 6.0 - x2 / 120.0 + x4 / 5040.0 - x6 / 362880.0,
            -1.0 / 12.0 + x2 / 180.0 - x4 / 6720.0 + x6 / 453600.0,
            -1.0 / 60.0 + x2 / 1260.0 - x4 / 60480.0 + x6 / 4989600.0};
  }
  const auto [sine, cosine] = portable::sin_cos(angle);
  return {(1.0 - cosine) / x2, (angle - sine) / (x2 * angle),
          (angle * sine - 2.0 * (1.0 - cosine)) / x4,
          (3.0 * sine - angle * cosine - 2.0 * angle) / (x4 * angle)};
}

Matrix3d right_jacobian(const Vector3d& w) {
  const JacobianTerms terms = jacobian_terms(w.norm());
  const Matrix3d cross = skew(w);
  return Matrix3d::Identity() - terms.a * cross + terms.b * cross * cross;
}

// the rate of the right Jacobian times the rate of w
Vector3d jacobian_rate(const Vector3d& w, const Vector3d& rate) {
  const JacobianTerms terms = jacobian_terms(w.norm());
  const double along = w.dot(rate);
  const Vector3d cross = w.cross(rate);
  return -terms.a_rate * along * cross + terms.b_rate * along * w.cross(cross) +
         terms.b * rate.cross(cross);
}

}  // namespace

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
    // of the parabola through the three samples at an end
    const std::size_t last = steps_.size() - 1;
    velocities_.front() = 1.5 * steps_[0] - 0.5 * steps_[1];
    velocities_.back() = 1.5 * steps_[last] - 0.5 * steps_[last - 1];
  }
  solve();
}

// At sample i, with the cubic's second derivatives 6 step - 4 v - 2 u at its begin and
// -6 step + 2 v + 4 u at its end, u = J^-1 v_next, J the right Jacobian at the step:
//   2 J(step_{i-1}) v_{i-1} + 8 v_i + 2 J^-1(step_i) v_{i+1}
//       = 6 (step_{i-1} + step_i) - rate of J at the end of the piece before.
void RotationSpline::solve() {
  constexpr int kMaxRounds = 20;
  constexpr double kTolerance = 1e-13;  // rad a sample
  const std::size_t last = velocities_.size() - 1;
  if (last < 2) return;
  std::vector<Matrix3d> upper(last), inverse_pivots(last);
  for (std::size_t i = 1; i < last; ++i) {
    Matrix3d pivot = 8.0 * Matrix3d::Identity();
    if (i > 1) pivot -= 2.0 * right_jacobian(steps_[i - 1]) * upper[i - 1];
    inverse_pivots[i] = pivot.inverse();
    upper[i] = inverse_pivots[i] * (2.0 * left_jacobian_inverse_so3(-steps_[i]));
  }
  std::vector<Vector3d> solution(last);
  for (int round = 0; round < kMaxRounds; ++round) {
    for (std::size_t i = 1; i < last; ++i) {
      const Vector3d& before = steps_[i - 1];
      const Vector3d end_rate = apply_left_jacobian_inverse_so3(-before, velocities_[i]);
      Vector3d right = 6.0 * (before + steps_[i]) - jacobian_rate(before, end_rate);
      right -= 2.0 * right_jacobian(before) * (i > 1 ? solution[i - 1] : velocities_[0]);
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
  // v s + c s^2 + d s^3
  const Vector3d c = 3.0 * step - 2.0 * v - u, d = v + u - 2.0 * step;
  const Vector3d theta = s * (v + s * (c + s * d));
  const Vector3d rate = v + s * (2.0 * c + 3.0 * s * d);
  const Vector3d second = 2.0 * c + 6.0 * s * d;
  const Matrix3d jacobian = right_jacobian(theta);
  return {(rotations_[i] * exp_so3(theta)).normalized(), jacobian * rate,
          jacobian * second + jacobian_rate(theta, rate)};
}

}  // namespace retarget
