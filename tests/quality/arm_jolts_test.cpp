#include "judge/quality/arm_jolts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "retarget/measure.h"
#include "retarget/motion.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

constexpr int kFrames = 300;

// A bump of the given height, degrees, that lasts `length` frames.
std::vector<double> bump(int begin, int length, double height) {
  std::vector<double> angles(kFrames, 2.0);
  for (int i = 0; i <= length; ++i) {
    const double wave = std::sin(std::numbers::pi * i / length);
    angles[static_cast<std::size_t>(begin + i)] += height * wave * wave;
  }
  return angles;
}

double jolts(const std::vector<double>& trunk, const std::vector<double>& arm,
             const FrameRate& rate = {30, 1}, const Posture& posture = upright_posture(kFrames)) {
  const RobotClip clip(robot_from_text(kOddRobot), rate, kFrames);
  const QualityOptions options;
  QualityReport report;
  const std::vector<SegmentAngles> segments = {{false, trunk}, {true, arm}};
  measure_arm_jolts({clip, options, report}, posture, segments);
  const MetricValue* found = report.find("arm_jolts");
  return found == nullptr ? -1.0 : found->value;
}

TEST(ArmJolts, CountsTrunksThatFollowAnArm) {
  EXPECT_EQ(jolts(bump(100, 10, 30.0), bump(100, 10, 60.0)), 1.0);
}

TEST(ArmJolts, NeedsBothTrunkAndArm) {
  EXPECT_EQ(jolts(bump(100, 10, 30.0), bump(100, 10, 10.0)), 0.0);
  EXPECT_EQ(jolts(bump(100, 10, 8.0), bump(100, 10, 60.0)), 0.0);
  EXPECT_EQ(jolts(bump(100, 10, 30.0), bump(200, 10, 60.0)), 0.0);
}

TEST(ArmJolts, IgnoresSlowBends) {
  EXPECT_EQ(jolts(bump(50, 60, 30.0), bump(50, 60, 60.0)), 0.0);
}

TEST(ArmJolts, IgnoresLyingFrames) {
  Posture posture = upright_posture(kFrames);
  std::fill_n(posture.upright.begin() + 80, 60, 0);
  EXPECT_EQ(jolts(bump(100, 10, 30.0), bump(100, 10, 60.0), {30, 1}, posture), 0.0);
  EXPECT_EQ(jolts(bump(200, 10, 30.0), bump(200, 10, 60.0), {30, 1}, posture), 1.0);
}

TEST(ArmJolts, CountsTimesHalfASecondApart) {
  std::vector<double> trunk = bump(50, 10, 30.0), arm = bump(50, 10, 60.0);
  for (int i = 0; i < kFrames; ++i) {
    trunk[static_cast<std::size_t>(i)] += bump(200, 10, 30.0)[static_cast<std::size_t>(i)] - 2.0;
    arm[static_cast<std::size_t>(i)] += bump(200, 10, 60.0)[static_cast<std::size_t>(i)] - 2.0;
  }
  EXPECT_EQ(jolts(trunk, arm), 2.0);
}

TEST(ArmJolts, MeasuresInSecondsNotFrames) {
  EXPECT_EQ(jolts(bump(100, 40, 30.0), bump(100, 40, 60.0), {120, 1}), 1.0);
  EXPECT_EQ(jolts(bump(100, 40, 30.0), bump(100, 40, 60.0), {30, 1}), 0.0);
}

}  // namespace
}  // namespace retarget
