// Compares the factorization of a block-tridiagonal matrix with Eigen's LLT: random blocks of the
// size of a 20 s window of the G1.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

#include "solve/fit/block_chain.h"

namespace retarget {
namespace {

constexpr int kSize = 35, kBlocks = 600;

struct ChainCase {
  std::vector<Eigen::MatrixXd> blocks;
  std::vector<Eigen::VectorXd> rights, couplings;

  ChainCase() {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal;
    const auto random = [&] { return normal(engine); };
    for (int t = 0; t < kBlocks; ++t) {
      const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(kSize, kSize, random);
      blocks.emplace_back(a * a.transpose() + 10.0 * Eigen::MatrixXd::Identity(kSize, kSize));
      rights.emplace_back(Eigen::VectorXd::NullaryExpr(kSize, random));
      couplings.emplace_back(Eigen::VectorXd::NullaryExpr(kSize, random));
    }
  }
};

void chain_by_sweeps(benchmark::State& state) {
  const ChainCase problem;
  BlockChain chain(kSize, state.range(0) != 0 && has_avx2());
  for (auto _ : state) {
    chain.begin(kBlocks);
    for (int t = 0; t < kBlocks; ++t) {
      const auto n = static_cast<std::size_t>(t);
      // The matrix is symmetric, so rows are columns.
      for (int i = 0; i < kSize; ++i) {
        std::copy_n(problem.blocks[n].col(i).data(), kSize, chain.block(t) + i * chain.stride());
      }
      std::copy_n(problem.rights[n].data(), kSize, chain.right(t));
      std::copy_n(problem.couplings[n].data(), kSize, chain.coupling(t));
      if (!chain.eliminate(t)) state.SkipWithError("not positive definite");
    }
    chain.substitute();
    benchmark::DoNotOptimize(chain.solution(0).data());
  }
  state.SetItemsProcessed(state.iterations() * kBlocks);
}
BENCHMARK(chain_by_sweeps)->ArgName("wide")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// S_t = H_t - C_t S_(t-1)^-1 C_t, with the inverse from the factor
void chain_by_llt(benchmark::State& state) {
  const ChainCase problem;
  std::vector<Eigen::MatrixXd> inverses(kBlocks, Eigen::MatrixXd(kSize, kSize));
  std::vector<Eigen::VectorXd> solutions(kBlocks);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(kSize, kSize);
  Eigen::MatrixXd s(kSize, kSize);
  Eigen::VectorXd b(kSize);
  Eigen::LLT<Eigen::MatrixXd> llt(kSize);
  for (auto _ : state) {
    for (std::size_t t = 0; t < kBlocks; ++t) {
      s = problem.blocks[t];
      b = problem.rights[t];
      if (t > 0) {
        const auto c = problem.couplings[t].asDiagonal();
        s.noalias() -= c * inverses[t - 1] * c;
        b -= c * solutions[t - 1];
      }
      llt.compute(s);
      if (llt.info() != Eigen::Success) state.SkipWithError("not positive definite");
      inverses[t] = llt.solve(identity);
      solutions[t] = llt.solve(b);
    }
    for (std::size_t t = kBlocks - 1; t-- > 0;) {
      b = problem.couplings[t + 1].cwiseProduct(solutions[t + 1]);
      solutions[t].noalias() -= inverses[t] * b;
    }
    benchmark::DoNotOptimize(solutions[0].data());
  }
  state.SetItemsProcessed(state.iterations() * kBlocks);
}
BENCHMARK(chain_by_llt)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace retarget
