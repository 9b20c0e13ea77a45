#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace retarget {

/// A moving rotation. The velocity is in rad per sample and the acceleration in rad per sample
/// squared, both in the axes of the rotating body.
struct RotationState {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// Interpolates rotations on a uniform grid with continuous angular velocity and acceleration.
/// Between samples i and i + 1 the rotation is R_i exp(theta(s)) with a cubic theta. The angular
/// velocities at the samples are chosen so that the accelerations are continuous. They solve a
/// block-tridiagonal system with a small term that depends on the solution, so the system is
/// iterated (N. Mayorov, "Spline interpolation of rotations", 2019). About a fixed axis, this is
/// the cubic spline of the angle. At both ends, the angular velocity follows the parabola through
/// the three outermost samples, so a constant angular acceleration about one axis is reproduced
/// exactly.
///
/// The rotations of math/spline.h cost less, but where the axis changes only their velocity is
/// continuous.
class RotationSpline {
 public:
  RotationSpline() = default;
  /// @param rotations  unit quaternions, each less than half a turn from its neighbours; signs are
  ///     ignored.
  explicit RotationSpline(std::span<const Eigen::Quaterniond> rotations);

  /// @param sample  first sample of the piece; the last sample is piece n - 2 at s = 1.
  /// @param s       fraction of the piece, in [0, 1].
  [[nodiscard]] RotationState at(int sample, double s) const;

 private:
  void solve();

  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> steps_;       // log(R_i^-1 R_{i+1}).
  std::vector<Eigen::Vector3d> velocities_;  // At the samples.
};

}  // namespace retarget
