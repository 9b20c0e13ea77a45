#include "base/math/banded_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace retarget {
namespace {

TEST(Pentadiagonal, IsTheLeastSquaresSolution) {
  constexpr int kCount = 9;
  PentadiagonalFit fit(kCount);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * kCount - 3, kCount);
  Eigen::VectorXd targets(rows.rows());
  int row = 0;
  const auto weight = [](int i) { return 0.5 + 0.3 * std::sin(2.0 * i); };
  const auto target = [](int i) { return std::cos(3.0 * i); };
  for (int i = 0; i < kCount; ++i, ++row) {
    fit.add_value(i, weight(row), target(row));
    rows(row, i) = std::sqrt(weight(row));
    targets[row] = std::sqrt(weight(row)) * target(row);
  }
  for (int i = 0; i + 1 < kCount; ++i, ++row) {
    fit.add_difference(i, weight(row), target(row));
    rows(row, i) = -std::sqrt(weight(row));
    rows(row, i + 1) = std::sqrt(weight(row));
    targets[row] = std::sqrt(weight(row)) * target(row);
  }
  for (int i = 0; i + 2 < kCount; ++i, ++row) {
    fit.add_second_difference(i, weight(row), target(row));
    rows(row, i) = rows(row, i + 2) = std::sqrt(weight(row));
    rows(row, i + 1) = -2.0 * std::sqrt(weight(row));
    targets[row] = std::sqrt(weight(row)) * target(row);
  }
  const Eigen::VectorXd expected = rows.colPivHouseholderQr().solve(targets);
  const std::vector<double> found = fit.solve();
  for (int i = 0; i < kCount; ++i) EXPECT_NEAR(found[i], expected[i], 1e-12);
}

TEST(Pentadiagonal, MatrixSolvesColumns) {
  constexpr int kCount = 12;
  constexpr std::size_t kStride = 3;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kCount, kCount);
  PentadiagonalMatrix matrix;
  matrix.begin(40);
  matrix.begin(kCount);
  for (int i = 0; i < kCount; ++i) {
    const double weight = std::abs(normal(random));
    Eigen::VectorXd row = Eigen::VectorXd::Zero(kCount);
    if (i + 2 < kCount && i % 3 > 0) {
      row.segment(i, 3) << 1.0, -2.0, 1.0;
      matrix.add_second_difference(i, weight);
    } else if (i + 1 < kCount) {
      row.segment(i, 2) << -1.0, 1.0;
      matrix.add_difference(i, weight);
    }
    dense += weight * row * row.transpose();
  }
  for (int i = 0; i < kCount; ++i) {
    EXPECT_NEAR(matrix.absolute_row_sum(i), dense.row(i).cwiseAbs().sum(), 1e-12);
  }
  for (int i = 0; i < kCount; ++i) matrix.add_value(i, 1.0);
  dense += Eigen::MatrixXd::Identity(kCount, kCount);
  matrix.factorise();
  std::vector<double> right(kStride * kCount), x(right.size());
  for (double& value : right) value = normal(random);
  matrix.solve(right.data(), x.data(), kStride, std::array{0, 2});
  for (const int column : {0, 2}) {
    const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<kStride>> b(right.data() + column,
                                                                              kCount);
    const Eigen::VectorXd expected = dense.inverse() * b;
    for (int i = 0; i < kCount; ++i) {
      EXPECT_NEAR(x[kStride * static_cast<std::size_t>(i) + static_cast<std::size_t>(column)],
                  expected[i], 1e-12);
    }
  }
  EXPECT_EQ(x[1], 0.0);
}

TEST(Pentadiagonal, SmoothingKeepsRamps) {
  std::vector<double> ramp;
  for (int i = 0; i < 40; ++i) ramp.push_back(0.25 * i - 3.0);
  const std::vector<double> found = smoothed(ramp, 1e4);
  for (int i = 0; i < 40; ++i) EXPECT_NEAR(found[i], ramp[i], 1e-9);
}

TEST(Pentadiagonal, SmoothingHalvesItsFrequency) {
  constexpr double kFrequency = 0.3;  // rad per sample
  std::vector<double> tone;
  for (int i = 0; i < 400; ++i) tone.push_back(std::sin(kFrequency * i));
  const std::vector<double> found = smoothed(tone, std::pow(kFrequency, -4.0));
  // Far from the ends; differences of samples are slightly smaller than derivatives.
  for (int i = 150; i < 250; ++i) EXPECT_NEAR(found[i], 0.5 * tone[i], 0.01);
}

TEST(Pentadiagonal, ShortTracksAreKept) {
  EXPECT_TRUE(smoothed({}, 10.0).empty());
  EXPECT_EQ(smoothed({2.0}, 10.0), std::vector<double>({2.0}));
  const std::vector<double> two = smoothed({1.0, 5.0}, 10.0);
  EXPECT_EQ(two, std::vector<double>({1.0, 5.0}));
}

}  // namespace
}  // namespace retarget
