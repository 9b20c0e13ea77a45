// Required forces and torques of movements with a known solution.

#include "solve/dynamics/motion_dynamics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "robot/shipped_robots.h"
#include "solve/dynamics/support_points.h"

namespace retarget {
namespace {

// The G1 in its zero configuration, with its soles on the floor.
RobotClip standing_clip(int frames, double fps = 30.0) {
  const auto robot = load_shipped("unitree_g1");
  RobotClip clip(robot, frame_rate_from_fps(fps), frames);
  std::vector<Pose> bodies(robot->bodies().size());
  forward_kinematics(*robot, clip.qpos(0), bodies);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Sole& sole : robot->profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      lowest = std::min(lowest, (bodies[static_cast<std::size_t>(sole.body)] * point).z());
    }
  }
  for (int t = 0; t < frames; ++t) clip.qpos(t)[2] -= lowest;
  return clip;
}

double bad_share(const MotionDynamics& dynamics) {
  const auto bad = std::ranges::count_if(dynamics.samples, &DynamicsSample::is_bad);
  return static_cast<double>(bad) / static_cast<double>(dynamics.samples.size());
}

TEST(MotionDynamics, StandingIsFeasible) {
  const MotionDynamics dynamics = analyse_dynamics(standing_clip(30));
  EXPECT_EQ(dynamics.samples_per_frame, 4);
  EXPECT_EQ(dynamics.samples.size(), 29U * 4U);
  EXPECT_TRUE(dynamics.knows_torque_limits);
  for (const DynamicsSample& sample : dynamics.samples) {
    EXPECT_FALSE(sample.is_bad());
    EXPECT_TRUE(sample.supported);
    EXPECT_LT(sample.unexplained_force.norm(), 1e-3);
    EXPECT_LT(sample.com_acceleration.norm(), 1e-9);
    EXPECT_GT(sample.zmp_margin, 0.0);
    EXPECT_LT(sample.zmp_margin, 0.1);
    EXPECT_LT(sample.friction, 1e-9);
    EXPECT_LT(sample.torque_ratio, 0.5);
  }
}

// The whole robot swings horizontally: the required force is known, and friction supplies part of
// it.
TEST(MotionDynamics, SwayingRequiresFriction) {
  constexpr double kRate = 2.0 * 3.14159265358979;  // rad/s
  for (const double peak : {2.0, 12.0}) {
    RobotClip clip = standing_clip(60);
    for (int t = 0; t < 60; ++t) {
      clip.qpos(t)[1] += peak / (kRate * kRate) * std::sin(kRate * t / 30.0);
    }
    const MotionDynamics dynamics = analyse_dynamics(clip);
    double largest = 0.0;
    for (const DynamicsSample& sample : dynamics.samples) {
      largest = std::max(largest, sample.com_acceleration.norm());
    }
    EXPECT_NEAR(largest, peak, 0.05 * peak);
    if (peak > 10.0) {
      EXPECT_GT(bad_share(dynamics), 0.3);
    } else {
      double friction = 0.0;
      for (const DynamicsSample& sample : dynamics.samples) {
        if (std::isfinite(sample.friction)) friction = std::max(friction, sample.friction);
      }
      EXPECT_NEAR(friction, peak / 9.81, 0.03);
    }
  }
}

TEST(MotionDynamics, FreeFallIsFeasibleAndHoveringIsNot) {
  RobotClip thrown = standing_clip(30), hovering = standing_clip(30);
  for (int t = 0; t < 30; ++t) {
    const double time = t / 30.0;
    thrown.qpos(t)[2] += 0.5 + 5.0 * time - 0.5 * 9.81 * time * time;
    hovering.qpos(t)[2] += 0.5;
  }
  const MotionDynamics free = analyse_dynamics(thrown), held = analyse_dynamics(hovering);
  EXPECT_EQ(bad_share(free), 0.0);
  EXPECT_EQ(bad_share(held), 1.0);
  for (const DynamicsSample& sample : free.samples) {
    EXPECT_FALSE(sample.supported);
    EXPECT_LT(sample.unexplained_force.norm(), 1e-6);
  }
  for (const DynamicsSample& sample : held.samples) {
    EXPECT_NEAR(sample.unexplained_force.z(), 1.0, 1e-9);
  }
}

// A floor that is a few millimetres off is found from the standing soles.
TEST(MotionDynamics, PlacesTheFloorAtThePlantedSoles) {
  RobotClip clip = standing_clip(60);
  for (int t = 0; t < 60; ++t) clip.qpos(t)[2] += 0.03;
  const MotionDynamics dynamics = analyse_dynamics(clip);
  EXPECT_NEAR(dynamics.floor_height, 0.03, 1e-3);
  EXPECT_EQ(bad_share(dynamics), 0.0);
}

// Moves the frames from `begin` to a height.
void raise(RobotClip& clip, int begin, double height) {
  for (int i = begin; i < clip.frame_count(); ++i) clip.qpos(i)[2] += height;
}

TEST(StandingFloor, IsTheLowestLevelOfSolesThatStand) {
  for (const double floor : {-0.3, 0.0, 0.5}) {
    RobotClip clip = standing_clip(120);
    const double level = standing_floor(clip);
    raise(clip, 0, floor);
    EXPECT_NEAR(standing_floor(clip), floor + level, 1e-6) << floor;
    // On a box for most of the time.
    raise(clip, 30, 0.4);
    EXPECT_NEAR(standing_floor(clip), floor + level, 1e-6) << floor;
  }
}

TEST(StandingFloor, IsNotABoxAboveABriefStance) {
  RobotClip clip = standing_clip(120);
  raise(clip, 8, 0.4);
  EXPECT_EQ(standing_floor(clip), 0.0);
}

TEST(StandingFloor, IsNotMovedByASingleFrame) {
  RobotClip clip = standing_clip(120);
  raise(clip, 0, 0.5);
  const double level = standing_floor(clip);
  clip.qpos(60)[2] -= 0.3;
  EXPECT_NEAR(standing_floor(clip), level, 1e-6);
}

// On each of two levels, the soles stand for less than half a second.
TEST(StandingFloor, IsNearZeroIfNoLevelHasEnoughTime) {
  RobotClip clip = standing_clip(14);
  raise(clip, 0, -0.05);
  raise(clip, 7, 0.1);
  EXPECT_NEAR(standing_floor(clip), 0.0, 0.051);
  EXPECT_NE(standing_floor(clip), 0.0);
}

TEST(MotionDynamics, ReportsNothingForShortClips) {
  EXPECT_TRUE(analyse_dynamics(standing_clip(2)).samples.empty());
  EXPECT_EQ(analyse_dynamics(standing_clip(3)).samples.size(), 8U);
}

TEST(MotionDynamics, OtherRatesAreSampledAsFinely) {
  EXPECT_EQ(analyse_dynamics(standing_clip(10, 120.0)).samples_per_frame, 1);
  EXPECT_EQ(analyse_dynamics(standing_clip(10, 50.0)).samples_per_frame, 2);
  EXPECT_EQ(bad_share(analyse_dynamics(standing_clip(20, 50.0))), 0.0);
}

TEST(SupportPolygon, MarginIsTheDistanceToTheEdge) {
  using Points = std::vector<Eigen::Vector2d>;
  const auto margin = [](const Eigen::Vector2d& point, Points points) {
    return margin_in_hull(point, points);
  };
  const Points square = {{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 0}};
  EXPECT_NEAR(margin({1, 1}, square), 1.0, 1e-15);
  EXPECT_NEAR(margin({1.5, 1}, square), 0.5, 1e-15);
  EXPECT_NEAR(margin({3, 1}, square), -1.0, 1e-15);
  EXPECT_NEAR(margin({3, 3}, square), -std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(margin({0, 1}, {{0, 0}}), -1.0, 1e-15);
  EXPECT_NEAR(margin({0.5, 1}, {{0, 0}, {1, 0}}), -1.0, 1e-15);
  EXPECT_NEAR(margin({0.5, 1}, {{0, 0}, {1, 0}, {2, 0}}), -1.0, 1e-15);
}

// As in a full-precision file of a standing robot: rotations between frames are so small that 1 -
// cos is 0.
TEST(MotionDynamics, StandingWithSensorNoiseIsFeasible) {
  for (const double size : {1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 1.5e-8, 1e-7}) {
    RobotClip clip = standing_clip(30);
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, size);
    for (int t = 0; t < clip.frame_count(); ++t) {
      const auto qpos = clip.qpos(t);
      for (std::size_t i = 4; i < qpos.size(); ++i) qpos[i] += noise(random);
    }
    const MotionDynamics dynamics = analyse_dynamics(clip);
    EXPECT_EQ(bad_share(dynamics), 0.0) << size;
    for (const DynamicsSample& sample : dynamics.samples) {
      EXPECT_LT(sample.unexplained_force.norm(), 1e-3) << size;
      EXPECT_LT(sample.com_acceleration.norm(), 1e-9 + 2e4 * size) << size;
      EXPECT_LT(sample.torque_ratio, 0.5) << size;
    }
  }
}

// A frame that overflows is bad and has no figures; the others are still measured.
TEST(MotionDynamics, RejectsMovementsBeyondTheNumberRange) {
  RobotClip clip = standing_clip(30);
  clip.qpos(10)[0] = 1e200;
  clip.qpos(20)[12] = 1e305;
  const MotionDynamics dynamics = analyse_dynamics(clip);
  ASSERT_EQ(dynamics.samples.size(), 29U * 4U);
  const auto unknown = std::ranges::count_if(dynamics.samples, [](const DynamicsSample& sample) {
    EXPECT_TRUE(std::isfinite(sample.torque_ratio) || sample.torque_link < 0);
    return !sample.unexplained_force.allFinite();
  });
  EXPECT_GT(unknown, 0);
  EXPECT_EQ(bad_share(dynamics), 1.0);
}

TEST(SupportPolygon, OmitsNonFiniteCorners) {
  std::vector<Eigen::Vector2d> corners = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int i = 0; i < 40; ++i) {
    const double nan = std::nan("");
    corners.insert(corners.begin() + i % 5, Eigen::Vector2d(i % 2 == 0 ? nan : 0.5, nan));
  }
  EXPECT_DOUBLE_EQ(margin_in_hull({0.5, 0.4}, corners), 0.4);
}

}  // namespace
}  // namespace retarget
