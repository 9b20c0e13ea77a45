// Bounded steps agree with MuJoCo's box QP; bounded minima satisfy the optimality conditions.

#include "solve/ik/box_qp.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/math/least_squares.h"

namespace retarget {
namespace {

using Eigen::VectorXd;

TEST(DenseLeastSquares, AgreesWithMuJoCosBoxQp) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int bound = 0;
  for (int n = 0; n < 200; ++n) {
    const int size = 1 + n % 7;
    DenseLeastSquares system(size);
    const Eigen::MatrixXd A =
        Eigen::MatrixXd::NullaryExpr(size + 2, size, [&] { return normal(random); });
    system.hessian = A.transpose() * A;
    for (int i = 0; i < size; ++i) {
      system.gradient[i] = 2.0 * normal(random);
      system.lower[i] = -0.3 * std::abs(normal(random));
      system.upper[i] = 0.3 * std::abs(normal(random));
      system.unit[i] = 0.5 + std::abs(normal(random));
    }
    const double damping = 0.1;
    const auto norm = system.solve(damping);
    ASSERT_TRUE(norm.has_value());
    EXPECT_EQ(*norm, system.step.norm());

    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> H = system.hessian;
    for (int i = 0; i < size; ++i) H(i, i) += damping / (system.unit[i] * system.unit[i]);
    VectorXd expected = VectorXd::Zero(size);
    std::vector<mjtNum> factor(static_cast<std::size_t>(size * (size + 7)));
    std::vector<int> index(static_cast<std::size_t>(size));
    ASSERT_GE(mju_boxQP(expected.data(), factor.data(), index.data(), H.data(),
                        system.gradient.data(), size, system.lower.data(), system.upper.data()),
              0);
    EXPECT_LT((system.step - expected).cwiseAbs().maxCoeff(), 1e-6) << n;
    for (int i = 0; i < size; ++i) {
      bound +=
          static_cast<int>(system.step[i] == system.lower[i] || system.step[i] == system.upper[i]);
    }
  }
  EXPECT_GT(bound, 100);
}

TEST(DenseLeastSquares, ReportsNonFiniteSystems) {
  DenseLeastSquares system(2);
  system.hessian.setIdentity();
  system.lower.setConstant(-1.0);
  system.upper.setConstant(1.0);
  for (double* const value : {&system.gradient[1], &system.hessian(1, 0)}) {
    const double before = *value;
    *value = std::numeric_limits<double>::quiet_NaN();
    const auto norm = system.solve(0.0);
    EXPECT_TRUE(norm && std::isnan(*norm));
    *value = before;
  }
  system.gradient[0] = 0.5;
  EXPECT_EQ(system.solve(0.0), 0.5);
}

// Rosenbrock's function inside a box.
struct BoundedRosenbrock {
  VectorXd lower, upper, x, tried = x;
  DenseLeastSquares system = DenseLeastSquares(2);

  static double value(const VectorXd& x) {
    const double a = 10.0 * (x[1] - x[0] * x[0]), b = 1.0 - x[0];
    return 0.5 * (a * a + b * b);
  }
  static VectorXd slope(const VectorXd& x) {
    const double a = 10.0 * (x[1] - x[0] * x[0]), b = 1.0 - x[0];
    return Eigen::Vector2d(-20.0 * x[0] * a - b, 10.0 * a);
  }
  double cost() const { return value(x); }
  void linearise() {
    system.gradient = slope(x);
    system.hessian << 400.0 * x[0] * x[0] + 1.0, -200.0 * x[0], -200.0 * x[0], 100.0;
  }
  std::optional<double> solve(double damping) {
    system.lower = lower - x;
    system.upper = upper - x;
    return system.solve(damping);
  }
  double try_step(double length) {
    tried = (x + length * system.step).cwiseMax(lower).cwiseMin(upper);
    return value(tried);
  }
  void accept() { x = tried; }
  void reject() {}
};

TEST(DenseLeastSquares, FindsBoundedMinima) {
  const LeastSquaresPolicy policy{.max_steps = 200, .min_step = 1e-10};
  BoundedRosenbrock one{Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(0.5, 2.0),
                        Eigen::Vector2d(-1.2, 1.0)};
  EXPECT_EQ(damped_least_squares(one, policy).status, LeastSquaresStatus::kConverged);
  EXPECT_EQ(one.x[0], 0.5);
  EXPECT_NEAR(one.x[1], 0.25, 1e-9);

  // x is free and y is at its bound: the slope along x vanishes, the slope along y points outwards.
  BoundedRosenbrock other{Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(2.0, 0.1),
                          Eigen::Vector2d(0.1, -1.0)};
  EXPECT_EQ(damped_least_squares(other, policy).status, LeastSquaresStatus::kConverged);
  EXPECT_EQ(other.x[1], 0.1);
  const VectorXd slope = BoundedRosenbrock::slope(other.x);
  EXPECT_NEAR(slope[0], 0.0, 1e-6);
  EXPECT_LT(slope[1], -0.1);
}

}  // namespace
}  // namespace retarget
