#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace retarget::series {

/// Maps and Jacobians of SO(3) and SE(3) by their power series, the definitions, in long double:
/// without closed forms, switches and cancellation. Terms of angles up to pi stay below 12, so the
/// error is 1e-18 with a 64-bit long double.

using Real = long double;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Vector4 = Eigen::Matrix<Real, 4, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
using Matrix4 = Eigen::Matrix<Real, 4, 4>;
using Matrix6 = Eigen::Matrix<Real, 6, 6>;

inline constexpr int kTerms = 60;

inline Matrix3 cross(const Vector3& a) {
  Matrix3 matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

/// Sum of A^n / (n + shift)!, by Horner.
template <typename Matrix>
Matrix exponential(const Matrix& a, int shift) {
  Matrix sum = Matrix::Identity();
  for (int n = kTerms; n > 0; --n) {
    sum = Matrix::Identity() + (a * sum / static_cast<Real>(n + shift)).eval();
  }
  for (int n = shift; n > 1; --n) sum /= static_cast<Real>(n);
  return sum;
}

/// The unit quaternion exp(w / 2), scalar part first.
inline Vector4 quaternion(const Vector3& w) {
  Matrix4 times;  // Multiplication from the left with (0, w / 2).
  times << 0, -w.x(), -w.y(), -w.z(), w.x(), 0, -w.z(), w.y(), w.y(), w.z(), 0, -w.x(), w.z(),
      -w.y(), w.x(), 0;
  return exponential<Matrix4>(times / 2, 0).col(0);
}

inline Matrix3 left_jacobian(const Vector3& w) {
  return exponential<Matrix3>(cross(w), 1);
}

/// The rate of the right Jacobian sum (-W)^n / (n + 1)! at a rate of w, times that rate. Vector by
/// vector, for the first term, rate x rate, must be zero and not what rounding leaves of it.
inline Vector3 right_jacobian_rate(const Vector3& w, const Vector3& rate) {
  const Matrix3 a = -cross(w), b = -cross(rate);
  Vector3 power = rate, change = Vector3::Zero(), sum = change;  // Terms of (-W)^n times the rate.
  Real factorial = 1;
  for (int n = 1; n < kTerms; ++n) {
    change = (b * power + a * change).eval();
    power = (a * power).eval();
    factorial *= static_cast<Real>(n + 1);
    sum += change / factorial;
  }
  return sum;
}

/// The Jacobian of SE(3); linear components of a twist first.
inline Matrix6 left_jacobian(const Eigen::Matrix<Real, 6, 1>& x) {
  Matrix6 adjoint = Matrix6::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = cross(x.tail<3>());
  adjoint.topRightCorner<3, 3>() = cross(x.head<3>());
  return exponential<Matrix6>(adjoint, 1);
}

}  // namespace retarget::series
