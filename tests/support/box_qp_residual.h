#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace retarget {

/// Largest violation of the optimality conditions of a box QP at x: distance outside the box,
/// gradient of variables inside it, descent directions that point inward at a bound. Zero at the
/// solution.
inline double box_qp_residual(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                              const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                              const Eigen::VectorXd& x) {
  const Eigen::VectorXd gradients = g + H.selfadjointView<Eigen::Lower>() * x;
  double residual = 0.0;
  for (int i = 0; i < x.size(); ++i) {
    const double gradient = gradients[i];
    // At a bound, the gradient only violates optimality if descent leads into the box.
    double fault = std::abs(gradient);
    if (x[i] <= lower[i]) fault = std::max(0.0, -gradient);
    if (x[i] >= upper[i]) fault = std::min(fault, std::max(0.0, gradient));
    residual = std::max({residual, fault, lower[i] - x[i], x[i] - upper[i]});
  }
  return residual;
}

}  // namespace retarget
