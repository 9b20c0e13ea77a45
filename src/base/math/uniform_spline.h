#pragma once

#include <span>
#include <vector>

namespace retarget {

/// A value with its first two derivatives, per sample and per sample squared.
struct SplineState {
  double value = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
};

/// The cubic a + s (b + s (c + s d)) over a piece of a uniform cubic B-spline, s in [0, 1].
struct UniformCubic {
  double a, b, c, d;

  /// @param coefficients  the four B-spline coefficients of the piece.
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
  double speed = 0.0;  ///< Per sample.
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
  /// @param s  fraction of the piece, in [0, 1].
  [[nodiscard]] SplineState at(int piece, double s) const;

  /// Exact extremes over a piece: of its value, from the roots of the derivative, and of its
  /// velocity, a parabola.
  struct Range {
    SplineExtreme least, greatest;
  };
  [[nodiscard]] Range values(int piece) const;
  [[nodiscard]] Range velocities(int piece) const;

  /// Moves coefficients until no piece leaves the bounds. Each step projects the coefficients onto
  /// the half-space in which the worst point of a piece keeps its bound. Where samples exceed a
  /// bound themselves, the pieces within two of them have no such bound, so samples never move far:
  /// the correction removes what the spline adds between them.
  SplineCorrection keep_inside(const SplineBounds& bounds);

 private:
  [[nodiscard]] UniformCubic cubic(int piece) const {
    return UniformCubic(coefficients_.data() + piece);
  }
  struct PieceBounds;
  [[nodiscard]] std::vector<PieceBounds> piece_bounds(const SplineBounds& bounds) const;
  double correct(int piece, const PieceBounds& bounds);
  void move(int piece, double s, bool velocity, double change);

  std::vector<double> coefficients_;  // Of piece i: i to i + 3.
};

}  // namespace retarget
