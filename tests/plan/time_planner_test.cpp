#include "app/plan/time_planner.h"

#include <gtest/gtest.h>

#include <vector>

namespace retarget {
namespace {

// A torque remains too large although a fast joint slows the motion down around it.
TEST(TimePlanner, UnchangedPartsLieOutsideOfSlowedOnes) {
  TimePlanner planner(4.0, {30, 1});
  std::vector<StepNeed> needs;
  for (int step = 30; step < 60; ++step) {
    needs.push_back({step, StepNeed::kSpeed, 10.0, 1.5, "joint speed"});
  }
  needs.push_back({45, StepNeed::kTorque, 1.0, 1.5, "joint torque"});
  ASSERT_TRUE(planner.take(needs));
  int step = 0;
  while (planner.source_time(step) < 1.52) ++step;
  ASSERT_TRUE(planner.take({{step, StepNeed::kTorque, 1.0, 1.5, "joint torque"}}));
  const auto slowed = planner.decision().value();
  ASSERT_EQ(slowed.stretches.size(), 1U);
  EXPECT_LT(slowed.stretches[0].begin, 1.4);
  EXPECT_GT(slowed.stretches[0].end, 1.6);
  EXPECT_TRUE(slowed.left.empty());
}

// Without the joint, the same place has its usual time again.
TEST(TimePlanner, PartsWithoutEffectAreUnchanged) {
  TimePlanner planner(4.0, {30, 1});
  ASSERT_TRUE(planner.take({{45, StepNeed::kTorque, 1.0, 1.5, "joint torque"}}));
  int step = 0;
  while (planner.source_time(step) < 1.52) ++step;
  ASSERT_TRUE(planner.take({{step, StepNeed::kTorque, 1.0, 1.5, "joint torque"}}));
  planner.restore(1.4, 1.7);
  const auto slowed = planner.decision().value();
  EXPECT_TRUE(slowed.stretches.empty());
  ASSERT_EQ(slowed.left.size(), 1U);
  EXPECT_NEAR(slowed.left[0].begin, 1.5, 0.11);
}

}  // namespace
}  // namespace retarget
