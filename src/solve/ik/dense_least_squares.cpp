#include "solve/ik/dense_least_squares.h"

#include <limits>

namespace retarget {

DenseLeastSquares::DenseLeastSquares(int size)
    : hessian(Eigen::MatrixXd::Zero(size, size)),
      gradient(Eigen::VectorXd::Zero(size)),
      lower(Eigen::VectorXd::Zero(size)),
      upper(Eigen::VectorXd::Zero(size)),
      unit(Eigen::VectorXd::Ones(size)),
      step(Eigen::VectorXd::Zero(size)),
      damped_(hessian),
      qp_(size) {}

std::optional<double> DenseLeastSquares::solve(double damping) {
  damped_ = hessian;
  damped_.diagonal().array() += damping / unit.array().square();
  const BoxQpStats stats = qp_.solve(damped_, gradient, lower, upper, step);
  // BoxQp factorises nothing if a value is not finite.
  if (stats.factorizations == 0) return std::numeric_limits<double>::quiet_NaN();
  return step.norm();
}

}  // namespace retarget
