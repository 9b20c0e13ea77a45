#include "base/math/banded_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
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
