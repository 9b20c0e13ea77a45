#pragma once

#include <Eigen/Core>
#include <span>

namespace retarget {

/// Least-squares parabola through samples at equal intervals.
struct Parabola {
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  double residual = 0.0;  ///< Root mean square.
};

/// @param places  an odd number of samples, at least three
/// @param step    interval between samples, seconds
[[nodiscard]] Parabola fit_parabola(std::span<const Eigen::Vector3d> places, double step);

/// Number of samples to either side of the middle of a section in which a parabola shows free fall:
/// a tenth of a second or slightly less. In shorter sections, the rebound of a supported body is a
/// parabola, too. 0 if these are fewer than two samples: a parabola through three always fits.
[[nodiscard]] int free_fall_reach(double step);

}  // namespace retarget
