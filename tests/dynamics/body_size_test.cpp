// Robot size from the leg length, and the figures that scale with it.

#include "solve/dynamics/support_points.h"

#include <gtest/gtest.h>

#include <string>

#include "robot/shipped_robots.h"
#include "solve/dynamics/motion_dynamics.h"

namespace retarget {
namespace {

TEST(BodySize, IsTheLegLengthRelativeToTheG1) {
  EXPECT_EQ(body_size(*load_shipped("unitree_g1")), 1.0);
  EXPECT_EQ(body_size(*load_shipped("unitree_g1_with_hands")), 1.0);
  // Legs as measured by reports (docs/quality.md).
  const std::vector<std::pair<std::string, double>> legs = {
      {"booster_t1_29dof", 0.512}, {"engineai_pm01", 0.694}, {"fourier_n1", 0.569},
      {"pal_talos", 0.705},        {"pnd_adam_lite", 0.793}, {"stanford_toddy", 0.231},
      {"unitree_h1", 0.817}};
  for (const auto& [robot, leg] : legs) {
    EXPECT_NEAR(body_size(*load_shipped(robot)), leg / 0.632, 0.04) << robot;
  }
}

// A torque that is negligible for a G1 topples a robot of a third of its size.
TEST(BodySize, ScalesTorques) {
  DynamicsSample sample;
  sample.unexplained_torque << 0.02, 0.0, 0.0;
  EXPECT_FALSE(sample.is_bad());
  EXPECT_NEAR(sample.torque_as_force(), 0.02 / 0.3, 1e-12);
  sample.size = 0.37;
  EXPECT_TRUE(sample.is_bad());
  sample.unexplained_torque.setZero();
  sample.unexplained_force << 0.0, 0.0, 0.099;
  EXPECT_FALSE(sample.is_bad());
}

}  // namespace
}  // namespace retarget
