// The inverse of one block and the solver of a chain of blocks, against Eigen's dense solver.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "solve/fit/block_chain.h"
#include "solve/fit/symmetric_inverse.h"

namespace retarget {
namespace {

Eigen::MatrixXd random_positive(int size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd a =
      Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
  return a * a.transpose() + Eigen::MatrixXd::Identity(size, size);
}

TEST(NegativeInverse, IsTheNegatedInverse) {
  std::mt19937 random(1);
  for (const int size : {4, 8, 36, 60}) {
    const Eigen::MatrixXd wanted = random_positive(size, random);
    std::vector<double> a(static_cast<std::size_t>(size * size), 1e30), scratch(8 * a.size());
    for (int i = 0; i < size; ++i) {
      // The solver must not read the upper triangle.
      for (int j = 0; j <= i; ++j) a[static_cast<std::size_t>(i * size + j)] = wanted(i, j);
    }
    ASSERT_TRUE(negative_inverse(a.data(), size, scratch.data(), false));
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Rows> lower(a.data(), size, size);
    const Eigen::MatrixXd found = lower.selfadjointView<Eigen::Lower>();
    EXPECT_LT((found * wanted + Eigen::MatrixXd::Identity(size, size)).cwiseAbs().maxCoeff(), 1e-9);
    for (int i = 0; i < size; i += kInverseBlock) {
      const Eigen::Matrix4d block = lower.block<kInverseBlock, kInverseBlock>(i, i);
      EXPECT_EQ(block, block.transpose().eval());
    }
  }
}

TEST(NegativeInverse, ReportsMatricesThatAreNotPositiveDefinite) {
  std::vector<double> a(16, 0.0), scratch(64);
  for (std::size_t i = 0; i < 4; ++i) a[5 * i] = 1.0;
  a[10] = -1.0;
  EXPECT_FALSE(negative_inverse(a.data(), 4, scratch.data(), false));
  a[10] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(negative_inverse(a.data(), 4, scratch.data(), false));
}

TEST(NegativeInverse, WideVectorsGiveIdenticalBits) {
  if (!has_avx2()) GTEST_SKIP() << "the processor has no wide vectors";
  std::mt19937 random(3);
  for (const int size : {4, 12, 36, 40}) {
    const Eigen::MatrixXd matrix = random_positive(size, random);
    std::vector<double> plain(matrix.data(), matrix.data() + matrix.size()), wide = plain;
    std::vector<double> scratch(static_cast<std::size_t>(8 * size));
    ASSERT_TRUE(negative_inverse(plain.data(), size, scratch.data(), false));
    ASSERT_TRUE(negative_inverse(wide.data(), size, scratch.data(), true));
    EXPECT_EQ(std::memcmp(plain.data(), wide.data(), plain.size() * sizeof(double)), 0) << size;
  }
}

TEST(BlockChain, WideVectorsGiveIdenticalBits) {
  if (!has_avx2()) GTEST_SKIP() << "the processor has no wide vectors";
  constexpr int kSize = 35, kBlocks = 5;
  std::vector<std::vector<double>> solutions;
  for (const bool wide : {false, true}) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    BlockChain chain(kSize, wide);
    chain.begin(kBlocks);
    for (int t = 0; t < kBlocks; ++t) {
      const Eigen::MatrixXd h =
          random_positive(kSize, random) + 2.0 * Eigen::MatrixXd::Identity(kSize, kSize);
      for (int i = 0; i < kSize; ++i) {
        for (int j = 0; j <= i; ++j) chain.block(t)[i * chain.stride() + j] = h(i, j);
        chain.right(t)[i] = uniform(random);
        chain.coupling(t)[i] = uniform(random);
      }
      ASSERT_TRUE(chain.eliminate(t));
    }
    chain.substitute();
    auto& all = solutions.emplace_back();
    for (int t = 0; t < kBlocks; ++t) {
      all.insert(all.end(), chain.solution(t).begin(), chain.solution(t).end());
    }
  }
  EXPECT_EQ(
      std::memcmp(solutions[0].data(), solutions[1].data(), solutions[0].size() * sizeof(double)),
      0);
}

// Random chains; one of the blocks may be indefinite.
struct RandomChain {
  RandomChain(int size, int blocks, std::mt19937& random, int indefinite = -1) : chain(size) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    chain.begin(blocks);
    dense = Eigen::MatrixXd::Zero(blocks * size, blocks * size);
    right.resize(blocks * size);
    for (int t = 0; t < blocks; ++t) {
      Eigen::MatrixXd h = random_positive(size, random) / size;
      h.diagonal().array() += 3.0;
      if (t == indefinite) h(size / 2, size / 2) = -1.0;
      dense.block(t * size, t * size, size, size) = h;
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j <= i; ++j) chain.block(t)[i * chain.stride() + j] = h(i, j);
        right[t * size + i] = chain.right(t)[i] = uniform(random);
        if (t == 0) continue;
        const double coupling = chain.coupling(t)[i] = uniform(random);
        dense(t * size + i, (t - 1) * size + i) = dense((t - 1) * size + i, t * size + i) =
            coupling;
      }
    }
  }

  BlockChain chain;
  Eigen::MatrixXd dense;
  Eigen::VectorXd right;
};

TEST(BlockChain, MatchesADenseSolver) {
  std::mt19937 random(2);
  for (const int size : {1, 5, 35}) {
    constexpr int kBlocks = 7;
    RandomChain problem(size, kBlocks, random);
    for (int t = 0; t < kBlocks; ++t) ASSERT_TRUE(problem.chain.eliminate(t));
    problem.chain.substitute();
    const Eigen::VectorXd wanted = problem.dense.ldlt().solve(problem.right);
    for (int t = 0; t < kBlocks; ++t) {
      for (int i = 0; i < size; ++i) {
        EXPECT_NEAR(problem.chain.solution(t)[static_cast<std::size_t>(i)], wanted[t * size + i],
                    1e-9);
      }
    }
  }
}

TEST(BlockChain, AgreesWithEigensLlt) {
  std::mt19937 random(5);
  for (const int size : {2, 12, 29, 35, 43}) {
    constexpr int kBlocks = 12;
    RandomChain problem(size, kBlocks, random);
    for (int t = 0; t < kBlocks; ++t) ASSERT_TRUE(problem.chain.eliminate(t));
    problem.chain.substitute();
    const Eigen::LLT<Eigen::MatrixXd> llt(problem.dense);
    ASSERT_EQ(llt.info(), Eigen::Success);
    const Eigen::VectorXd wanted = llt.solve(problem.right);
    Eigen::VectorXd found(wanted.size());
    for (int t = 0; t < kBlocks; ++t) {
      std::ranges::copy(problem.chain.solution(t), found.data() + t * size);
    }
    EXPECT_LT((found - wanted).norm(), 1e-10 * wanted.norm()) << size;
  }
}

TEST(BlockChain, FailsAtTheBlockWhereEigensLltFails) {
  std::mt19937 random(6);
  constexpr int kSize = 29, kBlocks = 6;
  for (int indefinite = 0; indefinite < kBlocks; ++indefinite) {
    RandomChain problem(kSize, kBlocks, random, indefinite);
    for (int t = 0; t <= indefinite; ++t) {
      const int rows = (t + 1) * kSize;
      const Eigen::LLT<Eigen::MatrixXd> llt(problem.dense.topLeftCorner(rows, rows));
      EXPECT_EQ(llt.info() == Eigen::Success, t < indefinite);
      EXPECT_EQ(problem.chain.eliminate(t), t < indefinite) << t;
    }
  }
}

}  // namespace
}  // namespace retarget
