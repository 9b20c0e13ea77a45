// Minimal movement of a centre of mass with which contacts can carry it: closed forms, and
// comparison with nearby solutions.

#include "solve/dynamics/centroidal_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "solve/dynamics/inverse_dynamics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr CentroidalScale kScale{35.0, 0.3, 1.0 / 30.0};

// A stance on two feet, with the centre of mass 0.7 m high at the origin.
std::vector<CentroidalFrame> standing(int count) {
  std::vector<CentroidalFrame> frames(static_cast<std::size_t>(count));
  for (CentroidalFrame& frame : frames) {
    frame.needed << 0, 0, 1, 0, 0, 0;
    frame.cone.clear();
    for (const double x : {-0.05, 0.12}) {
      for (const double y : {-0.15, 0.15}) {
        frame.cone.add_point(Vector3d(x, y, -0.7) / kScale.length, 0.6);
      }
    }
  }
  return frames;
}

double missing(const std::vector<CentroidalFrame>& frames, const std::vector<Vector6d>& x,
               const std::vector<Vector6d>& accelerations) {
  ConeProjector projector;
  double sum = 0.0;
  for (std::size_t t = 2; t + 2 < frames.size(); ++t) {
    const Vector6d& xdd = accelerations[t];
    Vector6d wrench = frames[t].needed;
    wrench.head<3>() += xdd.head<3>() / kGravity;
    wrench.tail<3>() += xdd.tail<3>() / (kScale.mass * kGravity * kScale.length) +
                        x[t].head<3>().cross(Vector3d(frames[t].needed.head<3>())) / kScale.length;
    ForceCone cone = frames[t].cone;
    sum += projector.project(cone, wrench).norm();
  }
  return sum;
}

// A surge as a function of time, and a tremor of this size at half the frame rate.
std::vector<CentroidalFrame> surge(double fps, double shiver) {
  auto frames = standing(static_cast<int>(std::lround(2.0 * fps)) + 1);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const double s = (static_cast<double>(t) / fps - 1.0) / 0.1;
    frames[t].needed[0] -= 0.8 * s * std::exp(0.5 - 0.5 * s * s) + (t % 2 == 0 ? shiver : -shiver);
  }
  return frames;
}

// The requested motion of the body does not depend on the sampling rate.
TEST(CentroidalStep, IsIndependentOfTheFrameRate) {
  std::vector<Vector6d> at_30;
  for (const double fps : {30.0, 60.0, 120.0}) {
    const CentroidalScale scale{kScale.mass, kScale.length, 1.0 / fps};
    const auto stride = static_cast<std::size_t>(std::lround(fps / 30.0));
    for (const double shiver : {0.0, 0.3}) {
      if (fps <= 30.0 && shiver > 0.0) continue;
      auto frames = surge(fps, shiver);
      CentroidalStep step;
      step.find_unexplained(frames, scale);
      const std::vector<Vector6d> x = step.solve(frames, scale, 8);
      if (at_30.empty()) at_30 = x;
      double largest = 0.0, difference = 0.0;
      for (std::size_t t = 0; t < at_30.size(); ++t) {
        largest = std::max(largest, at_30[t].head<3>().norm());
        difference = std::max(difference, (x[t * stride] - at_30[t]).head<3>().norm());
      }
      EXPECT_GT(largest, 0.02);
      EXPECT_LT(difference, 0.1 * largest) << fps << " " << shiver;
    }
  }
}

TEST(CentroidalStep, DoesNotMoveAStandingBody) {
  auto frames = standing(40);
  CentroidalStep step;
  for (const Vector6d& x : step.solve(frames, kScale, 4)) EXPECT_LT(x.norm(), 1e-6);
  for (const Vector6d& rest : step.unexplained()) EXPECT_LT(rest.norm(), 1e-4);
}

// A surge of 0.8 g within three frames, as caused by feet that snap into place.
TEST(CentroidalStep, SmoothsASurge) {
  auto frames = standing(40);
  for (const int t : {18, 19}) frames[static_cast<std::size_t>(t)].needed[0] += 0.8;
  for (const int t : {20, 21}) frames[static_cast<std::size_t>(t)].needed[0] -= 0.8;
  CentroidalStep step;
  const std::vector<Vector6d> none(frames.size(), Vector6d::Zero());
  const double before = missing(frames, none, none);
  const std::vector<Vector6d> x = step.solve(frames, kScale, 6);
  EXPECT_GT(before, 1.0);
  EXPECT_LT(missing(frames, x, step.accelerations()), 0.15 * before);
  double largest = 0.0;
  for (const Vector6d& move : x) largest = std::max(largest, move.head<3>().norm());
  // Integrated twice, the surge is 0.8 g times four frames squared.
  EXPECT_LT(largest, 4.0 * 0.8 * kGravity * kScale.frame_time * kScale.frame_time);
  EXPECT_GT(largest, 1e-3);
}

// Without contacts, only free fall needs no force, so the path of a supported body is bent to it.
TEST(CentroidalStep, AFlyingBodyFalls) {
  auto frames = standing(40);
  for (std::size_t t = 15; t < 25; ++t) {
    frames[t].cone.clear();
    frames[t].needed << 0, 0, 0.4, 0, 0, 0.1;
  }
  CentroidalStep step;
  const std::vector<Vector6d> none(frames.size(), Vector6d::Zero());
  const std::vector<Vector6d> x = step.solve(frames, kScale, 8);
  EXPECT_LT(missing(frames, x, step.accelerations()), 0.4 * missing(frames, none, none));
  // It rises before and after, and falls between.
  EXPECT_GT(x[20][2], x[15][2]);
}

TEST(CentroidalStep, DoesNotMoveUntrustedFrames) {
  auto frames = standing(40);
  for (std::size_t t = 15; t < 25; ++t) frames[t].needed[0] += 0.9;
  for (CentroidalFrame& frame : frames) frame.trust = 0.0;
  CentroidalStep step;
  for (const Vector6d& x : step.solve(frames, kScale, 4)) EXPECT_LT(x.norm(), 1e-9);
}

TEST(CentroidalStep, DoesNotMoveTheEnds) {
  auto frames = standing(12);
  for (CentroidalFrame& frame : frames) frame.needed[0] += 0.9;
  CentroidalStep step;
  const std::vector<Vector6d> x = step.solve(frames, kScale, 4);
  // b0 = b1 = 0: there x = b2 / 6 at frame 1, and x'' = b2
  const double per_second = 1.0 / (kScale.frame_time * kScale.frame_time);
  for (const std::size_t t : {1, 10}) {
    EXPECT_GT(x[t].norm(), 1e-6);
    EXPECT_LT((step.accelerations()[t] - 6.0 * per_second * x[t]).norm(),
              1e-6 * step.accelerations()[t].norm());
  }
  auto few = standing(4);
  EXPECT_EQ(step.solve(few, kScale, 4).size(), 4U);
}

TEST(CentroidalStep, DoesNotStepFromNonFiniteValues) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), kInf, -kInf, 1e300}) {
    auto frames = surge(30.0, 0.0);
    frames[20].needed[1] = bad;
    CentroidalStep step;
    step.find_unexplained(frames, kScale);
    const std::vector<Vector6d> x = step.solve(frames, kScale, 8);
    EXPECT_TRUE(step.has_failed()) << bad;
    ASSERT_EQ(x.size(), frames.size());
    for (const Vector6d& each : x) EXPECT_EQ(each, Vector6d::Zero());
    for (const Vector6d& each : step.accelerations()) EXPECT_EQ(each, Vector6d::Zero());
    // The next problem must not depend on the previous one.
    frames = surge(30.0, 0.0);
    step.find_unexplained(frames, kScale);
    step.solve(frames, kScale, 8);
    EXPECT_FALSE(step.has_failed()) << bad;
  }
}

}  // namespace
}  // namespace retarget
