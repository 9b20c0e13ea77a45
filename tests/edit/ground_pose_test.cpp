#include "edit/ground_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "edit_sample.h"
#include "support/angles.h"

namespace retarget {
namespace {

using namespace edit_test;

using Cloud = std::vector<Eigen::Vector3d>;

// The distance at an angle, by definition; the best shift at an angle is the difference of the
// means.
double distance_at(const Cloud& a, const Cloud& b, const std::vector<double>& weights,
                   double angle) {
  double sum = 0.0, squares = 0.0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  const Eigen::AngleAxisd turn(angle, Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += weights[i];
    shift += weights[i] * (a[i] - turn * b[i]);
  }
  shift /= sum;
  shift.z() = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squares += weights[i] * (a[i] - turn * b[i] - shift).squaredNorm();
  }
  return std::sqrt(squares / sum);
}

double min_distance(const Cloud& a, const Cloud& b, const std::vector<double>& weights) {
  double best = 0.0;
  for (double angle = -kPi; angle < kPi; angle += 0.1) {
    if (distance_at(a, b, weights, angle) < distance_at(a, b, weights, best)) best = angle;
  }
  double low = best - 0.1, high = best + 0.1;
  for (int i = 0; i < 50; ++i) {
    const double left = low + (high - low) / 3.0, right = high - (high - low) / 3.0;
    const bool is_left = distance_at(a, b, weights, left) < distance_at(a, b, weights, right);
    (is_left ? high : low) = is_left ? right : left;
  }
  return distance_at(a, b, weights, 0.5 * (low + high));
}

TEST(PoseDistance, AlignmentIsTheNumericOptimum) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  for (int round = 0; round < 6; ++round) {
    // Rotated by any angle, including half turns, at which an arc tangent of one argument would
    // fail.
    const double angle = kPi * (round - 3) / 3.0;
    const Eigen::AngleAxisd turn(angle, Eigen::Vector3d::UnitZ());
    Cloud a, b;
    std::vector<double> weights;
    for (int i = 0; i < 25; ++i) {
      b.emplace_back(noise(random), noise(random), noise(random));
      a.push_back(turn * b.back() + Eigen::Vector3d(4.0, -7.0, 0.1) +
                  0.2 * Eigen::Vector3d(noise(random), noise(random), noise(random)));
      weights.push_back(0.2 + std::abs(noise(random)));
    }
    const CloudAlignment found = align_clouds(a, b, weights);
    EXPECT_NEAR(found.distance, min_distance(a, b, weights), 1e-9);
    EXPECT_NEAR(distance_at(a, b, weights, found.a_from_b.heading), found.distance, 1e-9);
  }
}

TEST(PoseDistance, NoiseFreeAlignmentIsExact) {
  const Cloud b = {{0, 0, 0}, {1, 0, 1}, {0.3, 2, 0.5}, {-1, 0.4, 2}};
  const GroundPose move{{3.0, -0.4}, 2.8};
  Cloud a;
  for (const auto& point : b) a.push_back(move.in_space() * point);
  const CloudAlignment found = align_clouds(a, b, std::vector<double>(4, 0.25));
  EXPECT_LT(found.distance, 1e-14);
  EXPECT_NEAR(found.a_from_b.heading, 2.8, 1e-14);
  EXPECT_LT((found.a_from_b.position - move.position).norm(), 1e-14);
}

TEST(PoseDistance, MapHasTheDistanceOfEachWindow) {
  const HumanClip a = data_sample("walk").human(), b = data_sample("turn_in_place").human();
  const std::vector<Bone> bones = common_bones(a, b);
  const PoseClouds in_a(a, bones), in_b(b, bones);
  const WindowDistance distance(in_a, in_b, 10);
  const int from = a.frame_count - 25;
  const auto map = distance.map(from, a.frame_count, 0, 20);
  for (int i = 0; i < 25; i += 3) {
    for (int j = 0; j < 20; j += 4) {
      EXPECT_NEAR(map[static_cast<std::size_t>(i * 20 + j)], distance.at(from + i, j).distance,
                  1e-5);
    }
  }
}

}  // namespace
}  // namespace retarget
