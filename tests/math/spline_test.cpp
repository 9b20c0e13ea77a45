#include "retarget/spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "retarget/so3.h"
#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

const Vector3d kSplineAxis = Vector3d(1.0, -2.0, 0.5).normalized();

std::vector<Vector3d> points_of(const std::function<double(double)>& f, int count) {
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(f(i), -f(i), 2.0 * f(i));
  return points;
}

double spline_at(const std::vector<Vector3d>& points, double place) {
  const auto velocities = spline_velocities(steps_between(points));
  const int i = std::min(static_cast<int>(place), static_cast<int>(points.size()) - 2);
  return interpolate_cubic(points[i], velocities[i], points[i + 1], velocities[i + 1], place - i)
      .x();
}

Quaterniond spline_at(const std::vector<Quaterniond>& rotations, double place) {
  const auto velocities = spline_velocities(steps_between(rotations));
  const int i = std::min(static_cast<int>(place), static_cast<int>(rotations.size()) - 2);
  return interpolate_cubic(rotations[i], velocities[i], rotations[i + 1], velocities[i + 1],
                           place - i);
}

TEST(Spline, ReproducesCubics) {
  const auto cubic = [](double t) { return 0.1 * t * t * t - t * t + 3.0 * t - 2.0; };
  for (const int count : {4, 5, 6, 20}) {
    const auto points = points_of(cubic, count);
    for (double t = 0.0; t <= count - 1; t += 0.125) {
      EXPECT_NEAR(spline_at(points, t), cubic(t), 1e-13 * std::pow(count, 3)) << count << " " << t;
    }
  }
}

TEST(Spline, HandlesShortTracks) {
  EXPECT_EQ(spline_velocities({}).size(), 1U);
  EXPECT_EQ(spline_velocities({}).front(), Vector3d::Zero());
  const auto line = points_of([](double t) { return 1.0 + t; }, 2);
  EXPECT_DOUBLE_EQ(spline_at(line, 0.25), 1.25);
  const auto parabola = points_of([](double t) { return t * t; }, 3);
  EXPECT_NEAR(spline_at(parabola, 0.5), 0.25, 1e-15);
  EXPECT_NEAR(spline_at(parabola, 1.5), 2.25, 1e-15);
}

TEST(Spline, HasContinuousVelocityAndAcceleration) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> points(12);
  for (auto& point : points) point.setConstant(normal(random));
  constexpr double kStep = 1e-4;
  for (int i = 1; i < 11; ++i) {
    const double p0 = spline_at(points, i);
    const double before1 = spline_at(points, i - kStep), before2 = spline_at(points, i - 2 * kStep);
    const double after1 = spline_at(points, i + kStep), after2 = spline_at(points, i + 2 * kStep);
    EXPECT_NEAR(3 * p0 - 4 * before1 + before2, -3 * p0 + 4 * after1 - after2, 1e-9) << i;
    EXPECT_NEAR((p0 - 2 * before1 + before2) / (kStep * kStep),
                (p0 - 2 * after1 + after2) / (kStep * kStep), 2e-2)
        << i;
  }
}

// The accuracy stated in the header, over all phases.
TEST(Spline, ErrorIsSmallForASineFrom24To30) {
  double inside = 0.0;
  double at_ends = 0.0;
  double linear = 0.0;
  for (int phase = 0; phase < 16; ++phase) {
    const auto sine = [&](double t) { return std::sin(2.0 * kPi * 3.0 * t / 24.0 + phase); };
    const auto points = points_of(sine, 49);
    const auto velocities = spline_velocities(steps_between(points));
    for (int k = 0; k <= 60; ++k) {
      const double place = k * 24.0 / 30.0;
      const int i = std::min(static_cast<int>(place), 47);
      const double value =
          interpolate_cubic(points[i], velocities[i], points[i + 1], velocities[i + 1], place - i)
              .x();
      const double error = std::abs(value - sine(place));
      double& worst = place < 5.0 || place > 43.0 ? at_ends : inside;
      worst = std::max(worst, error);
      const double straight = points[i].x() + (place - i) * (points[i + 1] - points[i]).x();
      linear = std::max(linear, std::abs(straight - sine(place)));
    }
  }
  EXPECT_LT(inside, 0.0011);
  EXPECT_LT(at_ends, 0.0042);
  EXPECT_NEAR(linear, 0.07, 0.008);
}

TEST(RotationSpline, PassesThroughTheSamples) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Quaterniond> rotations;
  for (int i = 0; i < 8; ++i) {
    rotations.push_back(exp_so3(Vector3d(normal(random), normal(random), normal(random))));
  }
  const auto velocities = spline_velocities(steps_between(rotations));
  for (int i = 0; i + 1 < 8; ++i) {
    const auto at = [&](double s) {
      return interpolate_cubic(rotations[i], velocities[i], rotations[i + 1], velocities[i + 1], s);
    };
    EXPECT_LE((at(0.0).coeffs() - rotations[i].coeffs()).norm(), 1e-15);
    EXPECT_NEAR(std::abs(at(1.0).dot(rotations[i + 1])), 1.0, 1e-15);
    EXPECT_NEAR(at(0.3).norm(), 1.0, 1e-15);
  }
}

TEST(RotationSpline, HasContinuousAngularVelocity) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.5);
  std::vector<Quaterniond> rotations = {Quaterniond::Identity()};
  for (int i = 1; i < 9; ++i) {
    const Vector3d step(normal(random), normal(random), normal(random));
    rotations.push_back(exp_so3(step) * rotations.back());
  }
  const auto velocities = spline_velocities(steps_between(rotations));
  constexpr double kStep = 1e-5;
  for (int i = 1; i < 8; ++i) {
    const Quaterniond inverse = rotations[i].conjugate();
    const Vector3d before = -log_so3(spline_at(rotations, i - kStep) * inverse) / kStep;
    const Vector3d after = log_so3(spline_at(rotations, i + kStep) * inverse) / kStep;
    EXPECT_LE((before - velocities[i]).norm(), 1e-3) << i;
    EXPECT_LE((after - velocities[i]).norm(), 1e-3) << i;
  }
}

TEST(RotationSpline, IsExactForConstantVelocity) {
  constexpr double kRate = 2.5;  // rad per sample, 16 turns in all
  std::vector<Quaterniond> rotations;
  for (int i = 0; i < 41; ++i) rotations.push_back(exp_so3(i * kRate * kSplineAxis));
  for (double place = 0.0; place <= 40.0; place += 0.0625) {
    const Quaterniond expected = exp_so3(place * kRate * kSplineAxis);
    EXPECT_LE(log_so3(spline_at(rotations, place) * expected.conjugate()).norm(), 1e-13) << place;
    const int i = std::min(static_cast<int>(place), 39);
    const Quaterniond linear = interpolate_linear(rotations[i], rotations[i + 1], place - i);
    EXPECT_LE(log_so3(linear * expected.conjugate()).norm(), 1e-13) << place;
  }
}

TEST(RotationSpline, MatchesTheAngleSplineAboutAFixedAxis) {
  const auto angle = [](double t) { return std::sin(0.7 * t) + 0.2 * t; };
  const auto angles = points_of(angle, 12);
  std::vector<Quaterniond> rotations;
  for (const auto& point : angles) rotations.push_back(exp_so3(point.x() * kSplineAxis));
  for (double place = 0.0; place <= 11.0; place += 0.1) {
    const Quaterniond expected = exp_so3(spline_at(angles, place) * kSplineAxis);
    EXPECT_LE(log_so3(spline_at(rotations, place) * expected.conjugate()).norm(), 1e-14) << place;
  }
}

// A rotation about changing axes: no closed spline, but the samples determine it well.
TEST(RotationSpline, FollowsChangingAxes) {
  const auto motion = [](double t) {
    return exp_so3({0.0, 0.0, 0.05 * t}) * exp_so3({0.6 * std::sin(0.3 * t), 0.0, 0.0}) *
           exp_so3({0.0, 0.5 * std::cos(0.25 * t), 0.0});
  };
  std::vector<Quaterniond> rotations;
  for (int i = 0; i < 40; ++i) rotations.push_back(motion(i));
  double worst = 0.0;
  double worst_linear = 0.0;
  for (double place = 0.0; place <= 39.0; place += 0.1) {
    const Quaterniond inverse = motion(place).conjugate();
    worst = std::max(worst, log_so3(spline_at(rotations, place) * inverse).norm());
    const int i = std::min(static_cast<int>(place), 38);
    const Quaterniond linear = interpolate_linear(rotations[i], rotations[i + 1], place - i);
    worst_linear = std::max(worst_linear, log_so3(linear * inverse).norm());
  }
  EXPECT_LT(worst, 5e-4);
  EXPECT_GT(worst_linear, 10.0 * worst);
}

TEST(RotationSpline, IgnoresQuaternionSigns) {
  const Quaterniond q0 = exp_so3({0.1, 0.2, 0.3});
  const Quaterniond q1 = exp_so3({0.4, -0.2, 0.5});
  const Quaterniond q1_flipped(-q1.coeffs());
  const Vector3d v0(0.1, 0.0, 0.2), v1(0.3, 0.1, 0.0);
  EXPECT_EQ(interpolate_cubic(q0, v0, q1, v1, 0.4).coeffs(),
            interpolate_cubic(q0, v0, q1_flipped, v1, 0.4).coeffs());
  EXPECT_EQ(interpolate_linear(q0, q1, 0.4).coeffs(),
            interpolate_linear(q0, q1_flipped, 0.4).coeffs());
  EXPECT_LE((interpolate_linear(q0, q1, 0.4).coeffs() - q0.slerp(0.4, q1).coeffs()).norm(), 1e-15);
}

TEST(SmoothStep, IsLevelAtBothEnds) {
  EXPECT_EQ(smooth_step(2.0, 4.0, 1.0), 0.0);
  EXPECT_EQ(smooth_step(2.0, 4.0, 2.0), 0.0);
  EXPECT_DOUBLE_EQ(smooth_step(2.0, 4.0, 2.5), 0.15625);
  EXPECT_DOUBLE_EQ(smooth_step(2.0, 4.0, 3.0), 0.5);
  EXPECT_EQ(smooth_step(2.0, 4.0, 4.0), 1.0);
  EXPECT_EQ(smooth_step(2.0, 4.0, 9.0), 1.0);
}

}  // namespace
}  // namespace retarget
