// Times the box QP on random problems of the G1's size and scale.

#include <benchmark/benchmark.h>

#include <limits>
#include <random>
#include <vector>

#include "solve/ik/box_qp.h"

namespace retarget {
namespace {

constexpr int kSize = 35;      // six of the free base and 29 joints
constexpr int kTaskRows = 84;  // 14 tasks
constexpr int kProblems = 64;  // More than one, so that the branch predictor cannot learn them.

struct Problem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g, lower, upper;
};

// The base is free. The limits of `tight` joints are so near that many of them become active.
Problem random_problem(std::mt19937& engine, int tight) {
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> joint(6, kSize - 1);
  const Eigen::MatrixXd J =
      Eigen::MatrixXd::NullaryExpr(kTaskRows, kSize, [&] { return 10.0 * normal(engine); });
  const Eigen::VectorXd error =
      Eigen::VectorXd::NullaryExpr(kTaskRows, [&] { return normal(engine); });
  Problem problem;
  problem.H = J.transpose() * J;
  problem.H.diagonal().array() += 0.5;
  problem.g = J.transpose() * error;
  problem.lower = Eigen::VectorXd::Constant(kSize, -1.0);
  problem.upper = Eigen::VectorXd::Constant(kSize, 1.0);
  problem.lower.head<6>().setConstant(-std::numeric_limits<double>::infinity());
  problem.upper.head<6>().setConstant(std::numeric_limits<double>::infinity());
  for (int i = 0; i < tight; ++i) {
    const int near = joint(engine);
    problem.lower[near] = -1e-3;
    problem.upper[near] = 1e-3;
  }
  return problem;
}

// The argument is the number of joints near a limit.
void box_qp(benchmark::State& state) {
  std::mt19937 engine(7);
  std::vector<Problem> problems;
  for (int i = 0; i < kProblems; ++i) {
    problems.push_back(random_problem(engine, static_cast<int>(state.range(0))));
  }
  BoxQp qp(kSize);
  Eigen::VectorXd x(kSize);
  std::size_t next = 0;
  long active = 0, factorizations = 0;
  for (auto _ : state) {
    const Problem& problem = problems[next++ % kProblems];
    const BoxQpStats stats = qp.solve(problem.H, problem.g, problem.lower, problem.upper, x);
    benchmark::DoNotOptimize(x.data());
    active += (x.array() == problem.lower.array() || x.array() == problem.upper.array()).count();
    factorizations += stats.factorizations;
  }
  const auto solved = static_cast<double>(state.iterations());
  state.counters["active"] = static_cast<double>(active) / solved;
  state.counters["factorizations"] = static_cast<double>(factorizations) / solved;
}
BENCHMARK(box_qp)->Arg(0)->Arg(2)->Arg(5)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace retarget
