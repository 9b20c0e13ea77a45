#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace retarget {

/// A rotation on its way. Velocities are counted per sample, accelerations per sample squared, both
/// in the axes of what is turned.
struct RotationState {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// Rotations through samples on a uniform grid whose angular velocity and acceleration are
/// continuous: between samples i and i + 1 it is R_i exp(theta(s)) with a cubic theta, and the
/// angular velocities at the samples are such that accelerations meet there. That is a block
/// tridiagonal system with a small term that depends on the solution, iterated (N. Mayorov,
/// "Spline interpolation of rotations", 2019). About a fixed axis it is the cubic spline of the
/// angle. At both ends the angular velocity is that of the parabola through the three samples there,
/// so that a constant angular acceleration about one axis is kept exactly.
///
/// math/spline.h's rotations are continuous in velocity only where the axis changes; they cost less.
class RotationSpline {
 public:
  RotationSpline() = default;
  /// @param rotations  units, each less than half a turn from its neighbours; signs do not matter.
  explicit RotationSpline(std::span<const Eigen::Quaterniond> rotations);

  /// @param sample  the piece that begins with it; the last sample itself is piece n - 2 at 1.
  /// @param s       in [0, 1], the way to the next.
  [[nodiscard]] RotationState at(int sample, double s) const;

 private:
  void solve();

  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> steps_;       // log(R_i^-1 R_{i+1})
  std::vector<Eigen::Vector3d> velocities_;  // at the samples
};

}  // namespace retarget
