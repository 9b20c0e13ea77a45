#include "formats/bvh/euler_angles.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace retarget {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kRadians = std::numbers::pi / 180.0;

// An independent computation with rotation matrices.
Quaterniond composed(const std::vector<int>& axes, const std::vector<double>& angles) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    matrix = matrix * AngleAxisd(angles[i] * kRadians, Vector3d::Unit(axes[i])).toRotationMatrix();
  }
  return Quaterniond(matrix);
}

double angle_between(const Quaterniond& a, const Quaterniond& b) {
  return a.angularDistance(b) / kRadians;
}

std::vector<double> decompose(const Quaterniond& rotation, const std::vector<int>& axes,
                              const std::vector<double>& nearest_to, double* miss) {
  std::vector<double> angles(axes.size());
  *miss = euler_angles(rotation, axes, nearest_to, angles);
  return angles;
}

const std::vector<std::vector<int>> kThreeTurnOrders = {
    {0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0},   // Tait-Bryan
    {0, 1, 0}, {0, 2, 0}, {1, 0, 1}, {1, 2, 1}, {2, 0, 2}, {2, 1, 2}};  // proper Euler

TEST(EulerAngles, ComposesLeftToRight) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> degrees(-400.0, 400.0);
  for (const std::vector<int>& axes : kThreeTurnOrders) {
    const std::vector<double> angles = {degrees(random), degrees(random), degrees(random)};
    Quaterniond rotation = Quaterniond::Identity();
    for (int i = 0; i < 3; ++i) rotate_about(rotation, axes[i], angles[i]);
    EXPECT_LT(angle_between(rotation, composed(axes, angles)), 1e-10);
    EXPECT_NEAR(rotation.norm(), 1.0, 1e-14);
  }
}

TEST(EulerAngles, RepresentsEveryRotationInEveryOrder) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (const std::vector<int>& axes : kThreeTurnOrders) {
    for (int i = 0; i < 200; ++i) {
      const Quaterniond rotation =
          Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
      double miss = 1.0;
      const auto angles = decompose(rotation, axes, {0.0, 0.0, 0.0}, &miss);
      EXPECT_LT(miss, 1e-11);
      EXPECT_LT(angle_between(rotation, composed(axes, angles)), 1e-10);
      for (const double angle : angles) EXPECT_LE(std::abs(angle), 180.0 + 1e-9);
    }
  }
}

TEST(EulerAngles, IsAccurateNearGimbalLock) {
  for (const std::vector<int>& axes : kThreeTurnOrders) {
    const bool proper = axes[0] == axes[2];
    for (const double locked :
         proper ? std::array{0.0, 180.0, -180.0} : std::array{90.0, -90.0, 270.0}) {
      for (const double aside : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
        Quaterniond rotation = Quaterniond::Identity();
        rotate_about(rotation, axes[0], 33.0);
        rotate_about(rotation, axes[1], locked + aside);
        rotate_about(rotation, axes[2], -71.0);
        double miss = 1.0;
        decompose(rotation, axes, {10.0, 20.0, 30.0}, &miss);
        EXPECT_LT(miss, 1e-10) << axes[0] << axes[1] << axes[2] << " " << locked << " " << aside;
      }
    }
  }
}

TEST(EulerAngles, IsContinuousOverManyTurns) {
  // Angles that accumulate turns and pass through gimbal lock are recovered exactly.
  for (const std::vector<int>& axes : kThreeTurnOrders) {
    std::vector<double> before = {0.0, 45.0, 0.0};
    for (int frame = 0; frame < 2000; ++frame) {
      const std::vector<double> truth = {0.7 * frame, 45.0 + 100.0 * std::sin(0.01 * frame),
                                         -0.4 * frame};
      Quaterniond rotation = Quaterniond::Identity();
      for (int i = 0; i < 3; ++i) rotate_about(rotation, axes[i], truth[i]);
      if (frame % 3 == 1) rotation.coeffs() = -rotation.coeffs();
      double miss = 1.0;
      const auto angles = decompose(rotation, axes, before, &miss);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(angles[i], truth[i], 1e-8) << "frame " << frame;
      before = angles;
    }
  }
}

TEST(EulerAngles, IsContinuousAtGimbalLock) {
  for (const std::vector<int>& axes : kThreeTurnOrders) {
    const double locked = axes[0] == axes[2] ? 180.0 : 90.0;
    std::vector<double> before = {20.0, locked, 0.0};
    for (int frame = 0; frame < 500; ++frame) {
      Quaterniond rotation = Quaterniond::Identity();
      rotate_about(rotation, axes[0], 20.0 + 2.0 * frame);
      rotate_about(rotation, axes[1], locked);
      double miss = 1.0;
      const auto angles = decompose(rotation, axes, before, &miss);
      EXPECT_LT(miss, 1e-10);
      for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(angles[i] - before[i]), 2.0 + 1e-6);
      before = angles;
    }
  }
}

TEST(EulerAngles, HandlesFewerOrMoreThanThreeAngles) {
  const std::vector<std::vector<int>> lists = {
      {}, {1}, {0, 2}, {2, 0}, {1, 1}, {0, 0, 1}, {0, 1, 1}, {2, 2, 2}, {2, 0, 1, 2}, {1, 1, 0, 0}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> degrees(-180.0, 180.0);
  for (const std::vector<int>& axes : lists) {
    for (int i = 0; i < 100; ++i) {
      Quaterniond rotation = Quaterniond::Identity();
      for (const int axis : axes) rotate_about(rotation, axis, degrees(random));
      double miss = 1.0;
      decompose(rotation, axes, std::vector<double>(axes.size(), 0.0), &miss);
      EXPECT_LT(miss, 1e-10) << axes.size() << " turns";
    }
  }
}

TEST(EulerAngles, ReportsTheErrorOfUnreachableRotations) {
  Quaterniond rotation = Quaterniond::Identity();
  rotate_about(rotation, 0, 30.0);
  double miss = 0.0;
  decompose(rotation, {}, {}, &miss);
  EXPECT_NEAR(miss, 30.0, 1e-9);
  decompose(rotation, {1}, {0.0}, &miss);
  EXPECT_NEAR(miss, 30.0, 1e-9);
  rotate_about(rotation, 1, 40.0);
  rotate_about(rotation, 2, 50.0);
  decompose(rotation, {0, 1}, {0.0, 0.0}, &miss);
  EXPECT_GT(miss, 1.0);
}

}  // namespace
}  // namespace retarget
