// Replays in physics: standing, falling bodies, and motions that no controller can follow.

#include "retarget/simulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robot/shipped_robots.h"
#include "simulation/standing_clip.h"
#include "solve/dynamics/centroidal_map.h"
#include "support/value_of.h"

namespace retarget {
namespace {

SimulationReport report_of(const RobotClip& clip) {
  auto done = value_of(simulate(clip));
  return done.report;
}

TEST(Simulate, StandingBodyStands) {
  const SimulationReport report = report_of(standing_clip(load_shipped("unitree_g1"), 60));
  EXPECT_FALSE(report.fell);
  EXPECT_EQ(report.frames, 60);
  EXPECT_LT(report.root_cm.p95, 1.0);
  EXPECT_LT(report.joint_deg.p95, 1.0);
  EXPECT_LT(report.torque_p99_ratio, 1.0);
  EXPECT_EQ(report.unsolved_steps, 0);
}

TEST(Simulate, FloorIsAtTheHeightOfTheSoles) {
  RobotClip clip = standing_clip(load_shipped("unitree_g1"), 60);
  double last = 0.0;
  for (const double height : {-0.3, 0.075, 0.1, 1.0}) {
    for (int i = 0; i < 60; ++i) clip.qpos(i)[2] += height - last;
    last = height;
    const SimulationReport report = report_of(clip);
    EXPECT_FALSE(report.fell) << height;
    EXPECT_LT(report.root_cm.p95, 1.0) << height;
  }
}

TEST(Simulate, LeaningBodyFalls) {
  for (const double lean : {0.52, -0.52}) {
    const SimulationReport report = report_of(standing_clip(load_shipped("unitree_g1"), 90, lean));
    EXPECT_TRUE(report.fell);
    EXPECT_GT(report.fall_frame, 0);
    EXPECT_LT(report.fall_time_s, 2.0);
    EXPECT_FALSE(report.fall_reason.empty());
  }
}

// A root that moves by half a metre within a frame.
TEST(Simulate, JumpingRootIsLost) {
  RobotClip clip = standing_clip(load_shipped("unitree_g1"), 60);
  for (int i = 30; i < 60; ++i) clip.qpos(i)[1] += 0.5;
  const SimulationReport report = report_of(clip);
  EXPECT_TRUE(report.fell);
  EXPECT_NEAR(report.fall_time_s, 1.0, 0.2);
}

// Without contacts the centre of mass falls freely: z - g t^2 / 2, in steps of the integrator.
TEST(Simulate, BodyInTheAirFallsFreely) {
  RobotClip clip = standing_clip(load_shipped("unitree_g1"), 13);
  const Inertias inertias = make_inertias(clip.robot());
  CentroidalMap map(clip.robot().tree(), inertias);
  const auto height = [&](const RobotClip& of, int frame) {
    map.update(TreeState(of.robot().tree(), of.qpos(frame)));
    return map.com().z();
  };
  const double start = clip.qpos(0)[2] + 1.0;
  for (int i = 0; i < 13; ++i) {
    const double t = i / 30.0;
    clip.qpos(i)[2] = start - 9.81 / 2.0 * t * t;
  }
  auto done = value_of(simulate(clip));
  EXPECT_FALSE(done.report.fell);
  const int steps = static_cast<int>(std::lround(1.0 / 30.0 / done.report.time_step));
  const double step = done.report.time_step;
  for (int i = 0; i < 13; ++i) {
    const double n = static_cast<double>(i) * steps;
    EXPECT_NEAR(height(done.motion, i), height(clip, 0) - 9.81 * step * step * n * (n + 1.0) / 2.0,
                1e-6);
  }
}

TEST(Simulate, IsDeterministic) {
  const RobotClip clip = standing_clip(load_shipped("booster_t1"), 45, 0.05);
  const auto one = simulate(clip), other = simulate(clip);
  ASSERT_TRUE(one && other);
  for (int i = 0; i < clip.frame_count(); ++i) {
    EXPECT_TRUE(std::ranges::equal(one->motion.qpos(i), other->motion.qpos(i)));
  }
  EXPECT_EQ(simulation_json(one->report), simulation_json(other->report));
}

TEST(Simulate, InfeasibleMotionsTerminate) {
  RobotClip clip = standing_clip(load_shipped("unitree_g1"), 20);
  for (int i = 5; i < 20; ++i) {
    clip.qpos(i)[2] += 1e4 * (i % 2);
    clip.qpos(i)[10] = 50.0 * (i % 3);
  }
  const SimulationReport report = report_of(clip);
  EXPECT_TRUE(report.fell);
  EXPECT_TRUE(std::isfinite(report.root_cm.mean));
}

TEST(Simulate, RejectsShortAndStoppedRuns) {
  const auto robot = load_shipped("unitree_g1");
  EXPECT_FALSE(simulate(standing_clip(robot, 2)));
  SimulateOptions stop;
  stop.is_stopped = [] { return true; };
  const auto stopped = simulate(standing_clip(robot, 10), stop);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace retarget
