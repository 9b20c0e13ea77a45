#include "base/math/rotation_spline.h"

#include <Eigen/LU>
#include <algorithm>

#include "retarget/so3.h"

namespace retarget {

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
//       = 6 (step_{i-1} + step_i) - rate of J at the end of the previous piece.
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
