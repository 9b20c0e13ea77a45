// The inverse of one block and the solver of a chain of blocks, against Eigen's dense solver.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "refine/block_chain.h"
#include "refine/symmetric_inverse.h"

namespace retarget {
namespace {

Eigen::MatrixXd random_positive(int size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd a =
      Eigen::MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
  return a * a.transpose() + Eigen::MatrixXd::Identity(size, size);
}

TEST(NegativeInverse, IsTheInverseWithAMinus) {
  std::mt19937 random(1);
  for (const int size : {4, 8, 36, 60}) {
    const Eigen::MatrixXd wanted = random_positive(size, random);
    std::vector<double> a(static_cast<std::size_t>(size * size), 1e30), scratch(8 * a.size());
    for (int i = 0; i < size; ++i) {
      // what is above the diagonal must not count
      for (int j = 0; j <= i; ++j) a[static_cast<std::size_t>(i * size + j)] = wanted(i, j);
    }
    ASSERT_TRUE(negative_inverse(a.data(), size, scratch.data()));
    const Eigen::Map<const Eigen::MatrixXd> found(a.data(), size, size);
    EXPECT_LT((found * wanted + Eigen::MatrixXd::Identity(size, size)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_EQ(found, found.transpose().eval());
  }
}

TEST(NegativeInverse, SaysWhatIsNotPositiveDefinite) {
  std::vector<double> a(16, 0.0), scratch(64);
  for (std::size_t i = 0; i < 4; ++i) a[5 * i] = 1.0;
  a[10] = -1.0;
  EXPECT_FALSE(negative_inverse(a.data(), 4, scratch.data()));
  a[10] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(negative_inverse(a.data(), 4, scratch.data()));
}

TEST(BlockChain, SolvesAsADenseSolverDoes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const int size : {1, 5, 35}) {
    constexpr int kBlocks = 7;
    BlockChain chain(size);
    chain.begin(kBlocks);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kBlocks * size, kBlocks * size);
    Eigen::VectorXd right(kBlocks * size);
    for (int t = 0; t < kBlocks; ++t) {
      // coupling below the diagonal's least eigenvalue keeps the whole positive definite
      const Eigen::MatrixXd h =
          random_positive(size, random) + 2.0 * Eigen::MatrixXd::Identity(size, size);
      dense.block(t * size, t * size, size, size) = h;
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j <= i; ++j) chain.block(t)[i * chain.stride() + j] = h(i, j);
        right[t * size + i] = chain.right(t)[i] = uniform(random);
        if (t == 0) continue;
        const double coupling = chain.coupling(t)[i] = uniform(random);
        dense(t * size + i, (t - 1) * size + i) = coupling;
        dense((t - 1) * size + i, t * size + i) = coupling;
      }
      ASSERT_TRUE(chain.eliminate(t));
    }
    chain.substitute();
    const Eigen::VectorXd wanted = dense.ldlt().solve(right);
    for (int t = 0; t < kBlocks; ++t) {
      for (int i = 0; i < size; ++i) {
        EXPECT_NEAR(chain.solution(t)[static_cast<std::size_t>(i)], wanted[t * size + i], 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace retarget
