#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// Support and zero-moment point at one instant, horizontally.
struct BalanceSample {
  /// Zero-moment point: where a force on the floor has the moment that the motion needs. Metres.
  Eigen::Vector2d zmp = Eigen::Vector2d::Zero();
  /// Points that bear, metres; none in flight.
  std::vector<Eigen::Vector2d> support;
  /// Vertical force over mass times height of the centre of mass, 1/s^2; 0 in flight.
  double pull = 0.0;
};

/// The point of a support area that is nearest to a point: of the convex hull of `support`, shrunk
/// about its middle.
/// @param share  of the hull that remains, 0 to 1.
[[nodiscard]] Eigen::Vector2d nearest_in_support(const Eigen::Vector2d& point,
                                                 std::vector<Eigen::Vector2d> support,
                                                 double share);

/// Finds the shift x of the centre of mass with which the zero-moment point of every sample lies in
/// its support area: the bounded solution of
///
///     x'' = pull (x - d),   x(0) = x(end) = 0
///
/// where d is the shift of the zero-moment point into the support area. It is the linear inverted
/// pendulum with the future known: the body leans before it has to. In flight x is a straight line.
/// @param time_step  between two samples, seconds.
/// @return by sample, metres.
[[nodiscard]] std::vector<Eigen::Vector2d> balancing_shift(
    const std::vector<BalanceSample>& samples, double time_step, double share);

}  // namespace retarget
