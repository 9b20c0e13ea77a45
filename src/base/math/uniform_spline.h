#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace retarget {

/// A value with its first two derivatives, per sample and per sample squared.
struct SplineState {
  double value = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
};

/// The cubic a + s (b + s (c + s d)) over a segment of a uniform cubic B-spline, s in [0, 1].
struct UniformCubic {
  double a, b, c, d;

  /// @param coefficients  the four B-spline coefficients of the segment.
  explicit UniformCubic(const double* coefficients);

  [[nodiscard]] double value(double s) const { return a + s * (b + s * (c + s * d)); }
  [[nodiscard]] double velocity(double s) const { return b + s * (2.0 * c + 3.0 * s * d); }
  /// Integral from 0 to s.
  [[nodiscard]] double integral(double s) const {
    return s * (a + s * (b / 2.0 + s * (c / 3.0 + s * d / 4.0)));
  }
};

/// Location of the maximum or minimum of a function.
struct SplineExtreme {
  double value = 0.0;
  double at = 0.0;  ///< Samples since the first one.
};

/// Bounds for a spline, and the result of UniformSpline::keep_inside.
struct SplineBounds {
  double lower = 0.0, upper = 0.0;
  double speed = 0.0;  ///< Largest change per sample.
};
struct SplineCorrection {
  double largest = 0.0;  ///< Bound for the change of the spline; 0: unchanged.
  double at = 0.0;       ///< Position, samples.
  double excess =
      0.0;  ///< The part that remains beyond the bounds, relative to their width or the speed.
};

/// A cubic spline with continuous second derivative on a uniform grid, by its B-spline
/// coefficients: every choice of coefficients has this continuity. Piece i lies between samples i
/// and i + 1 and depends on four coefficients.
class UniformSpline {
 public:
  /// The spline with not-a-knot ends through samples, as spline_velocities(); at least one sample.
  explicit UniformSpline(std::span<const double> samples);

  [[nodiscard]] int piece_count() const { return static_cast<int>(coefficients_.size()) - 3; }
  /// @param s  fraction of the segment, in [0, 1].
  [[nodiscard]] SplineState at(int piece, double s) const;

  /// Exact extremes over a segment: of its value, from the roots of the derivative, and of its
  /// velocity, a parabola.
  struct Range {
    SplineExtreme least, greatest;
  };
  [[nodiscard]] Range values(int piece) const;
  [[nodiscard]] Range velocities(int piece) const;

  /// Moves coefficients until no segment leaves the bounds. Each step projects the coefficients
  /// onto the half-space in which the worst point of a segment keeps its bound. Where samples
  /// exceed a bound themselves, the segments within two of them have no such bound, so samples
  /// never move far: the correction removes what the spline adds between them.
  SplineCorrection keep_inside(const SplineBounds& bounds);

 private:
  [[nodiscard]] UniformCubic cubic(int piece) const {
    return UniformCubic(coefficients_.data() + piece);
  }
  struct PieceBounds;
  [[nodiscard]] std::vector<PieceBounds> piece_bounds(const SplineBounds& bounds) const;
  double correct(int piece, const PieceBounds& bounds);
  void move(int piece, double s, bool velocity, double change);

  std::vector<double> coefficients_;  // Segment i uses i to i + 3.
};

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

  /// @param sample  first sample of the segment; the last sample is segment n - 2 at s = 1.
  /// @param s       fraction of the segment, in [0, 1].
  [[nodiscard]] RotationState at(int sample, double s) const;

 private:
  void solve();

  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> steps_;       // log(R_i^-1 R_{i+1}).
  std::vector<Eigen::Vector3d> velocities_;  // At the samples.
};

}  // namespace retarget
