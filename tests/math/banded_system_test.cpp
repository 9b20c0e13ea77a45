#include "base/math/banded_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

namespace retarget {
namespace {

// A random positive definite band matrix.
Eigen::MatrixXd band_matrix(int size, int width, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(size, size);
  for (int i = 0; i < size; ++i) {
    for (int j = std::max(0, i - width + 1); j < i; ++j) L(i, j) = normal(random);
    L(i, i) = 1.0 + std::abs(normal(random));
  }
  return L * L.transpose();
}

BandedSystem system_of(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, int width) {
  BandedSystem system;
  system.begin(static_cast<std::size_t>(H.rows()), static_cast<std::size_t>(width));
  for (int i = 0; i < H.rows(); ++i) {
    double* const row = system.row(static_cast<std::size_t>(i));
    for (int j = std::max(0, i - width + 1); j <= i; ++j) row[j] = H(i, j);
    system.right()[static_cast<std::size_t>(i)] = b[i];
  }
  return system;
}

TEST(BandedSystem, AgreesWithADenseFactorisation) {
  for (const int width : {1, 2, 5, 18}) {
    const int size = 30;
    const Eigen::MatrixXd H = band_matrix(size, width, 1);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(size, -1.0, 2.0);
    const Eigen::VectorXd expected = H.ldlt().solve(b);
    BandedSystem system = system_of(H, b, width);
    const auto largest = system.solve(0, size);
    ASSERT_TRUE(largest.has_value());
    EXPECT_NEAR(*largest, expected.cwiseAbs().maxCoeff(), 1e-9 * (1.0 + *largest));
    for (int i = 0; i < size; ++i) {
      EXPECT_NEAR(system.right()[static_cast<std::size_t>(i)], expected[i], 1e-9 * (1.0 + *largest))
          << width << " " << i;
    }
  }
}

TEST(BandedSystem, OmitsVariables) {
  const int size = 12, first = 2, last = 9;
  const Eigen::MatrixXd H = band_matrix(size, 4, 2);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(size);
  BandedSystem system = system_of(H, b, 4);
  ASSERT_TRUE(system.solve(first, last).has_value());
  const Eigen::VectorXd expected = H.block(first, first, last - first, last - first)
                                       .ldlt()
                                       .solve(b.segment(first, last - first));
  for (int i = 0; i < size; ++i) {
    const bool solved = i >= first && i < last;
    EXPECT_NEAR(system.right()[static_cast<std::size_t>(i)], solved ? expected[i - first] : 0.0,
                1e-10 * (1.0 + expected.norm()))
        << i;
  }
}

TEST(BandedSystem, DistinguishesIndefiniteFromNonFinite) {
  Eigen::MatrixXd H = band_matrix(6, 3, 4);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(6);
  H(3, 3) = -1.0;
  EXPECT_FALSE(system_of(H, b, 3).solve(0, 6).has_value());
  H(3, 3) = std::numeric_limits<double>::quiet_NaN();
  const auto of_nan = system_of(H, b, 3).solve(0, 6);
  ASSERT_TRUE(of_nan.has_value());
  EXPECT_TRUE(std::isnan(*of_nan));
  Eigen::VectorXd infinite = b;
  infinite[5] = std::numeric_limits<double>::infinity();
  const auto of_right = system_of(band_matrix(6, 3, 4), infinite, 3).solve(0, 6);
  ASSERT_TRUE(of_right.has_value());
  EXPECT_TRUE(std::isnan(*of_right));
}

}  // namespace
}  // namespace retarget
