#include "solve/ik/box_qp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/box_qp_residual.h"

namespace retarget {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Problem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g, lower, upper;
};

// Scale and conditioning of inverse kinematics: weights of 10 to 100, squared.
Problem random_problem(std::mt19937& engine, int size, double tightness) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Problem problem;
  const Eigen::MatrixXd J =
      Eigen::MatrixXd::NullaryExpr(2 * size, size, [&] { return 10.0 * normal(engine); });
  problem.H = J.transpose() * J;
  problem.H.diagonal().array() += 0.5;
  problem.g = Eigen::VectorXd::NullaryExpr(size, [&] { return 100.0 * normal(engine); });
  problem.lower.resize(size);
  problem.upper.resize(size);
  for (int i = 0; i < size; ++i) {
    problem.lower[i] = uniform(engine) < 0.2 ? -kInfinity : -tightness * uniform(engine);
    problem.upper[i] = uniform(engine) < 0.2 ? kInfinity : tightness * uniform(engine);
  }
  return problem;
}

// Projected gradient descent: slow, simple, independent of the solver under test.
Eigen::VectorXd minimise_slowly(const Problem& problem) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.g.size());
  const double step = 1.0 / problem.H.norm();
  for (int i = 0; i < 400000; ++i) {
    x = (x - step * (problem.H * x + problem.g)).cwiseMax(problem.lower).cwiseMin(problem.upper);
  }
  return x;
}

int bound_count(const Problem& problem, const Eigen::VectorXd& x) {
  return static_cast<int>(
      (x.array() == problem.lower.array() || x.array() == problem.upper.array()).count());
}

TEST(BoxQp, SatisfiesKktConditionsOnRandomProblems) {
  std::mt19937 engine(3);
  int max_active = 0;
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const int size = 1 + repeat % 40;
    // From nearly all variables at a bound to nearly none.
    const Problem problem = random_problem(engine, size, std::pow(10.0, -3 + repeat % 5));
    BoxQp qp(size);
    Eigen::VectorXd x(size);
    const BoxQpStats stats = qp.solve(problem.H, problem.g, problem.lower, problem.upper, x);
    ASSERT_TRUE(stats.converged);
    ASSERT_TRUE((x.array() >= problem.lower.array()).all());
    ASSERT_TRUE((x.array() <= problem.upper.array()).all());
    ASSERT_LT(box_qp_residual(problem.H, problem.g, problem.lower, problem.upper, x), 1e-9)
        << "problem " << repeat;
    max_active = std::max(max_active, bound_count(problem, x));
  }
  EXPECT_GT(max_active, 20);
}

TEST(BoxQp, AgreesWithProjectedGradients) {
  std::mt19937 engine(5);
  for (int repeat = 0; repeat < 5; ++repeat) {
    const Problem problem = random_problem(engine, 6, 0.05);
    BoxQp qp(6);
    Eigen::VectorXd x(6);
    qp.solve(problem.H, problem.g, problem.lower, problem.upper, x);
    EXPECT_LT((x - minimise_slowly(problem)).norm(), 1e-9);
  }
}

TEST(BoxQp, ReadsOnlyTheLowerTriangle) {
  std::mt19937 engine(9);
  Problem problem = random_problem(engine, 8, 0.1);
  BoxQp qp(8);
  Eigen::VectorXd x(8), again(8);
  qp.solve(problem.H, problem.g, problem.lower, problem.upper, x);
  problem.H.triangularView<Eigen::StrictlyUpper>().setConstant(
      std::numeric_limits<double>::quiet_NaN());
  qp.solve(problem.H, problem.g, problem.lower, problem.upper, again);
  EXPECT_EQ(x, again);
}

TEST(BoxQp, HandlesFixedVariables) {
  const Eigen::MatrixXd H = 2.0 * Eigen::MatrixXd::Identity(3, 3);
  const Eigen::VectorXd g = Eigen::Vector3d(-2.0, -2.0, 2.0);
  const Eigen::VectorXd lower = Eigen::Vector3d(0.25, -1.0, -0.5);
  const Eigen::VectorXd upper = Eigen::Vector3d(0.25, 0.0, kInfinity);
  BoxQp qp(3);
  Eigen::VectorXd x(3);
  qp.solve(H, g, lower, upper, x);
  EXPECT_EQ(x, Eigen::VectorXd(Eigen::Vector3d(0.25, 0.0, -0.5)));
}

TEST(BoxQp, AcceptsInfeasibleStarts) {
  // A joint beyond its limit must return: both bounds are on one side of zero.
  const Eigen::MatrixXd H = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::VectorXd g = Eigen::Vector2d(0.0, 0.0);
  const Eigen::VectorXd lower = Eigen::Vector2d(0.3, -2.0);
  const Eigen::VectorXd upper = Eigen::Vector2d(0.9, -1.0);
  BoxQp qp(2);
  Eigen::VectorXd x(2);
  qp.solve(H, g, lower, upper, x);
  EXPECT_EQ(x, Eigen::VectorXd(Eigen::Vector2d(0.3, -1.0)));
}

TEST(BoxQp, ReportsNonFiniteValues) {
  BoxQp qp(2);
  Eigen::VectorXd x(2);
  const Eigen::VectorXd bound = Eigen::Vector2d(1.0, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(
      qp.solve(Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(nan, 0.0), -bound, bound, x)
          .converged);
  EXPECT_FALSE(qp.solve(Eigen::Matrix2d::Constant(nan), bound, -bound, bound, x).converged);
}

// In the first factorisation, in one after a bound, or in the gradient of a variable at its bound.
TEST(BoxQp, ReturnsAFinitePointInTheBoxForAnyInput) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), inf, -inf, 1e308}) {
    for (int place = 0; place < 12; ++place) {
      Eigen::MatrixXd H = 2.0 * Eigen::MatrixXd::Identity(3, 3);
      Eigen::VectorXd g = Eigen::Vector3d(-9.0, 1.0, 0.5);
      if (place < 9) {
        H(place / 3, place % 3) = H(place % 3, place / 3) = bad;
      } else {
        g[place - 9] = bad;
      }
      const Eigen::VectorXd bound = Eigen::Vector3d::Constant(1.5);
      BoxQp qp(3);
      Eigen::VectorXd x(3);
      const BoxQpStats stats = qp.solve(H, g, -bound, bound, x);
      EXPECT_TRUE(x.allFinite()) << place << ", " << bad;
      EXPECT_LE(x.cwiseAbs().maxCoeff(), 1.5);
      if (!std::isfinite(bad)) {
        EXPECT_FALSE(stats.converged) << place << ", " << bad;
      }
    }
  }
}

}  // namespace
}  // namespace retarget
