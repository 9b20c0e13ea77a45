// Joints at their limits, in motions that can be counted by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <vector>

#include "quality/walker.h"
#include "retarget/measure.h"
#include "robot/anatomy/limbs.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/self_test.h"
#include "support/angles.h"
#include "support/humanoids.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

// A waist with a range of one radian to each side, an ankle with a narrow range, a knee at its
// limit when the robot stands, a slide, a joint without limits.
constexpr const char* kJointed = R"(
<mujoco>
  <compiler angle="radian" inertiafromgeom="true"/>
  <default><geom size="0.02" mass="1"/></default>
  <worldbody>
    <body name="base"><freejoint/><geom/>
      <body name="a"><joint name="waist" axis="0 1 0" range="-1 1"/><geom/></body>
      <body name="b"><joint name="ankle" axis="0 1 0" range="-0.2 0.2"/><geom/></body>
      <body name="c"><joint name="knee" axis="0 1 0" range="0 2"/><geom/></body>
      <body name="d"><joint name="lift" type="slide" axis="0 0 1" range="-0.1 0.1"/><geom/></body>
      <body name="e"><joint name="wheel" axis="0 1 0"/><geom/></body>
      <body name="f"><joint name="J1_HEAD_PITCH" axis="0 1 0" range="-1 1"/><geom/></body>
    </body>
  </worldbody>
</mujoco>)";

constexpr int kWaist = 7, kAnkle = 8, kKnee = 9, kLift = 10, kWheel = 11, kHead = 12;

using Movement = std::function<void(int frame, std::span<double> qpos)>;

QualityReport measure(int frames, const Movement& movement) {
  const auto robot = robot_from_text(kJointed);
  RobotClip clip(robot, {30, 1}, frames);
  for (int frame = 0; frame < frames; ++frame) movement(frame, clip.qpos(frame));
  return measure_quality(clip, robot->model_limits());
}

TEST(AtLimit, StandingRobotHasNone) {
  const QualityReport report = measure(10, [](int, auto qpos) { qpos[kWheel] = 100.0; });
  EXPECT_EQ(figure(report, "at_limit_pct"), 0.0);
  EXPECT_EQ(figure(report, "joint_at_limit_pct"), 0.0);
  EXPECT_FALSE(report.at_limit);
}

TEST(AtLimit, CountsFramesForAnyJointAndTheWorstJoint) {
  // The waist in frames 0-3, 6 and 7, the ankle in 2-4.
  const QualityReport report = measure(10, [](int frame, auto qpos) {
    qpos[kWaist] = frame < 4 || frame == 6 || frame == 7 ? 0.995 : 0.98;
    qpos[kAnkle] = frame >= 2 && frame <= 4 ? -0.199 : -0.19;
  });
  EXPECT_DOUBLE_EQ(figure(report, "at_limit_pct"), 70.0);
  EXPECT_DOUBLE_EQ(figure(report, "joint_at_limit_pct"), 60.0);
  // 9 of 10 frames of four joints: the head and joints without a range do not count.
  EXPECT_DOUBLE_EQ(figure(report, "joint_frames_at_limit_pct"), 100.0 * 9 / 40);
  ASSERT_TRUE(report.at_limit);
  EXPECT_EQ(report.at_limit->joint, "waist");
  EXPECT_TRUE(report.at_limit->at_upper);
  EXPECT_DOUBLE_EQ(report.at_limit->frames_pct, 60.0);
  // The longest range, and the share of all frames.
  std::vector<Fault> faults;
  std::ranges::copy_if(report.faults, std::back_inserter(faults),
                       [](const Fault& fault) { return fault.metric == "joint_at_limit_pct"; });
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].where, "waist");
  EXPECT_EQ(faults[0].begin, 0);
  EXPECT_EQ(faults[0].end, 4);
  EXPECT_DOUBLE_EQ(faults[0].amount, 60.0);
  EXPECT_EQ(faults[1].where, "ankle");
}

TEST(AtLimit, ToleranceIsOnePercentOfNarrowRanges) {
  // 0.004 rad of 0.4, instead of 0.01.
  const auto at = [](double ankle) {
    return figure(measure(4, [&](int, auto qpos) { qpos[kAnkle] = ankle; }), "at_limit_pct");
  };
  EXPECT_EQ(at(0.1955), 0.0);
  EXPECT_EQ(at(0.1965), 100.0);
  EXPECT_EQ(at(0.3), 100.0);
  const auto lifted = [](double lift) {
    return figure(measure(4, [&](int, auto qpos) { qpos[kLift] = lift; }), "at_limit_pct");
  };
  EXPECT_EQ(lifted(0.0975), 0.0);
  EXPECT_EQ(lifted(0.0985), 100.0);
}

TEST(AtLimit, ExcludesHeadJoints) {
  const QualityReport report = measure(4, [](int, auto qpos) { qpos[kHead] = 1.0; });
  EXPECT_EQ(figure(report, "at_limit_pct"), 0.0);
}

TEST(AtLimit, IgnoresStraightKneeButNotBentKnee) {
  const auto at = [](double knee) {
    return figure(measure(4, [&](int, auto qpos) { qpos[kKnee] = knee; }), "joint_at_limit_pct");
  };
  EXPECT_EQ(at(0.0), 0.0);
  EXPECT_EQ(at(1.995), 100.0);
}

// A robot in the T-pose with both elbows at the end of their range, and a human whose elbows bend
// by `elbow` degrees.
QualityReport report_for_elbows(double elbow, int source_frames) {
  const auto robot = robot_from_text(tiny_humanoid(false));
  const RobotAnatomy limbs = find_limbs(*robot, "").value();
  const ResolvedConfig config = resolve_config(derive_config(*robot, limbs), *robot).value();
  HumanPosture posture;
  for (LimbPosture& side : posture) side.elbow = elbow * kDegree;
  HumanClip human = self_test_motion(limbs.forward);
  human.frame_count = source_frames;
  human.world_from_bone.assign(static_cast<std::size_t>(source_frames), posed_human(posture));
  RobotClip clip(robot, {30, 1}, 10);
  for (int frame = 0; frame < 10; ++frame) {
    for (const char* joint : {"left_elbow", "right_elbow"}) {
      const int index = robot->find_joint(joint).value();
      clip.qpos(frame)[static_cast<std::size_t>(robot->joints()[index].qpos_address)] = 2.2;
    }
  }
  const QualitySource source{&human, &config, ScaleRule::kLimbs};
  return measure_quality(clip, robot->model_limits(), &source);
}

TEST(AtLimit, IgnoresTimeThatThePoseRequires) {
  const QualityReport beyond = report_for_elbows(150.0, 10);
  EXPECT_EQ(figure(beyond, "joint_at_limit_pct"), 0.0);
  EXPECT_EQ(figure(beyond, "joint_beyond_range_pct"), 100.0);
  EXPECT_EQ(figure(beyond, "at_limit_pct"), 100.0);
  EXPECT_FALSE(beyond.at_limit);
  ASSERT_TRUE(beyond.beyond_range);
  EXPECT_EQ(beyond.beyond_range->joint, "left_elbow");
  EXPECT_TRUE(beyond.beyond_range->at_upper);
  EXPECT_THAT(report_text({&beyond, 1}),
              ::testing::HasSubstr("note: left_elbow is at its upper limit in 100 % of frames"));
  const QualityReport against = report_for_elbows(60.0, 10);
  EXPECT_EQ(figure(against, "joint_at_limit_pct"), 100.0);
  EXPECT_EQ(figure(against, "joint_beyond_range_pct"), 0.0);
  EXPECT_EQ(against.at_limit->joint, "left_elbow");
  // The demand is unknown after the end of the source.
  EXPECT_EQ(figure(report_for_elbows(150.0, 4), "joint_at_limit_pct"), 60.0);
}

}  // namespace
}  // namespace retarget
