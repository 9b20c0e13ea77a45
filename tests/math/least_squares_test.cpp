// Minima with known solutions, every stop criterion, damping and step lengths.

#include "base/math/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

namespace retarget {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// An unbounded problem given by its residual and Jacobian. Records the solver's evaluations.
struct TestProblem {
  std::function<VectorXd(const VectorXd&)> residual;
  std::function<MatrixXd(const VectorXd&)> jacobian;
  VectorXd x;
  VectorXd tried, step, gradient;
  MatrixXd hessian;
  std::vector<double> dampings;
  std::vector<VectorXd> points;  // Accepted points.
  int linearisations = 0;

  static double square(const VectorXd& r) { return 0.5 * r.squaredNorm(); }
  double cost() { return square(residual(x)); }
  void linearise() {
    ++linearisations;
    const MatrixXd J = jacobian(x);
    gradient = J.transpose() * residual(x);
    hessian = J.transpose() * J;
  }
  std::optional<double> solve(double damping) {
    dampings.push_back(damping);
    const MatrixXd damped = hessian + damping * MatrixXd::Identity(x.size(), x.size());
    const Eigen::LLT<MatrixXd> factor(damped);
    if (damped.allFinite() && factor.info() != Eigen::Success) return std::nullopt;
    step = -factor.solve(gradient);
    return step.norm();
  }
  double try_step(double length) {
    tried = x + length * step;
    return square(residual(tried));
  }
  void accept() {
    x = tried;
    points.push_back(x);
  }
  void reject() {}
};

VectorXd vector(double a, double b) {
  return Eigen::Vector2d(a, b);
}

TestProblem rosenbrock() {
  TestProblem problem;
  problem.residual = [](const VectorXd& x) {
    return vector(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
  };
  problem.jacobian = [](const VectorXd& x) {
    MatrixXd J(2, 2);
    J << -20.0 * x[0], 10.0, -1.0, 0.0;
    return J;
  };
  problem.x = vector(-1.2, 1.0);
  return problem;
}

// One variable; undamped Gauss-Newton steps diverge from |x| > 1.39.
TestProblem arc_tangent(double start) {
  TestProblem problem;
  problem.residual = [](const VectorXd& x) { return VectorXd(x.array().atan()); };
  problem.jacobian = [](const VectorXd& x) {
    return MatrixXd((1.0 / (1.0 + x.array().square())).matrix().asDiagonal());
  };
  problem.x = VectorXd::Constant(1, start);
  return problem;
}

TEST(LeastSquares, FindsTheMinimumOfRosenbrocksFunction) {
  TestProblem problem = rosenbrock();
  const auto result = damped_least_squares(problem, {.max_steps = 100, .min_step = 1e-9});
  EXPECT_EQ(result.status, LeastSquaresStatus::kConverged);
  EXPECT_NEAR(problem.x[0], 1.0, 1e-8);
  EXPECT_NEAR(problem.x[1], 1.0, 1e-8);
  EXPECT_LT(result.steps, 60);
  EXPECT_EQ(result.cost, problem.cost());
}

TEST(LeastSquares, OneUndampedStepSolvesALinearProblem) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const MatrixXd A = MatrixXd::NullaryExpr(7, 4, [&] { return normal(random); });
  const VectorXd b = VectorXd::NullaryExpr(7, [&] { return normal(random); });
  TestProblem problem;
  problem.residual = [&](const VectorXd& x) { return VectorXd(A * x - b); };
  problem.jacobian = [&](const VectorXd&) { return A; };
  problem.x = VectorXd::Zero(4);
  const auto result = damped_least_squares(problem, {.max_steps = 1, .initial_damping = 0.0});
  EXPECT_EQ(result.status, LeastSquaresStatus::kStepLimit);
  EXPECT_LT((problem.x - A.colPivHouseholderQr().solve(b)).norm(), 1e-12);
}

TEST(LeastSquares, SingularJacobianMovesOnlyAlongItsRows) {
  TestProblem problem;
  problem.residual = [](const VectorXd& x) {
    return vector(x[0] + x[1] - 1.0, 2.0 * (x[0] + x[1] - 1.0));
  };
  problem.jacobian = [](const VectorXd&) {
    MatrixXd J(2, 2);
    J << 1.0, 1.0, 2.0, 2.0;
    return J;
  };
  problem.x = vector(5.0, 2.0);
  const auto result = damped_least_squares(problem, {.min_damping = 1e-9, .min_step = 1e-9});
  EXPECT_EQ(result.status, LeastSquaresStatus::kConverged);
  EXPECT_NEAR(problem.x[0], 2.0, 1e-6);
  EXPECT_NEAR(problem.x[1], -1.0, 1e-6);
}

TEST(LeastSquares, NeverMovesFromANonFiniteStart) {
  TestProblem problem = rosenbrock();
  problem.x = vector(kNan, 1.0);
  const auto result = damped_least_squares(problem, {});
  EXPECT_EQ(result.status, LeastSquaresStatus::kNonFinite);
  EXPECT_EQ(result.steps, 0);
  EXPECT_TRUE(problem.points.empty());
  EXPECT_EQ(problem.linearisations, 0);
}

TEST(LeastSquares, NeverTakesANonFiniteStep) {
  for (const bool monotone : {true, false}) {
    TestProblem problem = rosenbrock();
    problem.jacobian = [](const VectorXd&) { return MatrixXd(MatrixXd::Constant(2, 2, kNan)); };
    const auto result = damped_least_squares(problem, {.monotone = monotone});
    EXPECT_EQ(result.status, LeastSquaresStatus::kNonFinite);
    EXPECT_EQ(problem.x, vector(-1.2, 1.0));
    EXPECT_EQ(result.cost, problem.cost());
  }
}

// The cost is NaN for x <= 0, where the first steps lead.
TEST(LeastSquares, RecoversFromStepsToNonFiniteValues) {
  TestProblem problem;
  problem.residual = [](const VectorXd& x) { return VectorXd(x.array().log()); };
  problem.jacobian = [](const VectorXd& x) {
    return MatrixXd(MatrixXd::Constant(1, 1, 1.0 / x[0]));
  };
  problem.x = VectorXd::Constant(1, 20.0);
  const auto result = damped_least_squares(problem, {.max_steps = 200, .min_step = 1e-9});
  EXPECT_EQ(result.status, LeastSquaresStatus::kConverged);
  EXPECT_NEAR(problem.x[0], 1.0, 1e-7);
  for (const VectorXd& point : problem.points) EXPECT_GT(point[0], 0.0);

  problem.x = VectorXd::Constant(1, 20.0);
  problem.points.clear();
  const auto gives_up = damped_least_squares(problem, {.min_increased = 1.0, .max_damping = 1e-2});
  EXPECT_EQ(gives_up.status, LeastSquaresStatus::kNonFinite);
  EXPECT_EQ(problem.x[0], 20.0);
  const auto unguarded = damped_least_squares(
      problem,
      {.initial_damping = 0.0, .min_increased = 1.0, .max_damping = 1.0, .monotone = false});
  EXPECT_EQ(unguarded.status, LeastSquaresStatus::kNonFinite);
  EXPECT_EQ(problem.x[0], 20.0);
}

TEST(LeastSquares, StopsAtTheStepLimit) {
  TestProblem problem = rosenbrock();
  const double before = problem.cost();
  const auto result = damped_least_squares(problem, {.max_steps = 10});
  EXPECT_EQ(result.status, LeastSquaresStatus::kStepLimit);
  EXPECT_EQ(result.steps, 10);
  EXPECT_LT(result.cost, before);
  EXPECT_EQ(result.cost, problem.cost());
}

TEST(LeastSquares, StallsWhereNoStepLowersTheCost) {
  TestProblem problem = arc_tangent(0.5);
  problem.jacobian = [](const VectorXd& x) {
    return MatrixXd((-1.0 / (1.0 + x.array().square())).matrix().asDiagonal());
  };
  const auto result = damped_least_squares(
      problem,
      {.initial_damping = 1e-2, .growth = 10.0, .min_increased = 0.5, .max_damping = 100.0});
  EXPECT_EQ(result.status, LeastSquaresStatus::kStalled);
  EXPECT_EQ(problem.x[0], 0.5);
  EXPECT_EQ(problem.dampings, (std::vector<double>{1e-2, 0.5, 5.0, 50.0}));
  EXPECT_EQ(problem.linearisations, 1);
}

TEST(LeastSquares, StallsIfTheMatrixIsNotPositiveDefinite) {
  TestProblem problem = rosenbrock();
  problem.jacobian = [](const VectorXd&) { return MatrixXd(MatrixXd::Zero(2, 2)); };
  const auto result = damped_least_squares(
      problem, {.initial_damping = 0.0, .min_increased = 1.0, .max_damping = 1.0});
  EXPECT_EQ(result.status, LeastSquaresStatus::kStalled);
  EXPECT_EQ(result.steps, 1);
  EXPECT_EQ(problem.x, vector(-1.2, 1.0));
}

TEST(LeastSquares, ShrinksTheDampingDownToItsMinimum) {
  TestProblem problem = arc_tangent(0.5);
  static_cast<void>(damped_least_squares(
      problem, {.max_steps = 4, .initial_damping = 1.0, .shrink = 0.25, .min_damping = 0.2}));
  EXPECT_EQ(problem.dampings, (std::vector<double>{1.0, 0.25, 0.2, 0.2}));
  EXPECT_EQ(problem.points.size(), 4u);
}

TEST(LeastSquares, CapsItsSteps) {
  TestProblem problem = rosenbrock();
  VectorXd last = problem.x;
  const auto result = damped_least_squares(
      problem, {.max_steps = 500, .max_step = 0.1, .relative_change = 1.0, .min_step = 1e-9});
  // Capped steps never count as converged, although all of them change the cost by less than itself.
  EXPECT_EQ(result.status, LeastSquaresStatus::kConverged);
  EXPECT_GT(problem.points.size(), 10u);
  for (const VectorXd& point : problem.points) {
    EXPECT_LE((point - last).norm(), 0.1 + 1e-12);
    last = point;
  }
}

TEST(LeastSquares, ConvergesAtASmallChangeOfTheCost) {
  TestProblem problem = rosenbrock();
  problem.residual = [](const VectorXd& x) { return Eigen::Vector3d(x[0], x[1], 1.0); };
  problem.jacobian = [](const VectorXd&) { return MatrixXd(MatrixXd::Identity(3, 2)); };
  problem.x = vector(1e-3, 0.0);
  const auto result = damped_least_squares(problem, {.relative_change = 1e-5});
  EXPECT_EQ(result.status, LeastSquaresStatus::kConverged);
  EXPECT_EQ(result.steps, 1);
}

TEST(LeastSquares, ALineSearchReplacesDamping) {
  const LeastSquaresPolicy line_search{.initial_damping = 0.0,
                                       .min_increased = 1.0,
                                       .max_damping = 1.0,
                                       .trials = 10,
                                       .shorten = 0.5,
                                       .min_step = 1e-9};
  TestProblem problem = arc_tangent(10.0);
  EXPECT_EQ(damped_least_squares(problem, line_search).status, LeastSquaresStatus::kConverged);
  EXPECT_NEAR(problem.x[0], 0.0, 1e-8);

  LeastSquaresPolicy full_steps = line_search;
  full_steps.trials = 1;
  problem = arc_tangent(10.0);
  EXPECT_EQ(damped_least_squares(problem, full_steps).status, LeastSquaresStatus::kStalled);
  EXPECT_EQ(problem.x[0], 10.0);
}

TEST(LeastSquares, WithoutSafeguardsTakesEveryFiniteStep) {
  const LeastSquaresPolicy policy{.max_steps = 3, .initial_damping = 0.0, .monotone = false};
  TestProblem problem = arc_tangent(2.0);
  double x = 2.0;
  EXPECT_EQ(damped_least_squares(problem, policy).status, LeastSquaresStatus::kStepLimit);
  ASSERT_EQ(problem.points.size(), 3u);
  for (const VectorXd& point : problem.points) {
    x -= std::atan(x) * (1.0 + x * x);
    EXPECT_NEAR(point[0], x, 1e-9 * std::abs(x));
  }
  EXPECT_GT(std::abs(x), 100.0);
}

}  // namespace
}  // namespace retarget
