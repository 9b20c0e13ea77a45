// The lean of trunks in poses with a known lean.

#include "judge/quality/similarity_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "retarget/human_skeleton.h"
#include "retarget/measure.h"
#include "support/angles.h"
#include "support/limbed_config.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Shoulders 6 cm in front of the hips and 40 cm above them: a line that leans by design; the torso
// bends about the middle of the hips.
constexpr const char* kLeaning = R"(
<mujoco>
  <compiler angle="radian" inertiafromgeom="true"/>
  <default><geom size="0.02" mass="1"/></default>
  <worldbody>
    <body name="pelvis" pos="0 0 0.6"><freejoint/><geom/>
      <body name="l_thigh" pos="0 0.1 0"><joint axis="0 1 0"/><geom/>
        <body name="l_shin" pos="0 0 -0.3"><joint axis="0 1 0"/><geom/>
          <body name="l_foot" pos="0 0 -0.3"><joint axis="0 1 0"/><geom/></body></body></body>
      <body name="r_thigh" pos="0 -0.1 0"><joint axis="0 1 0"/><geom/>
        <body name="r_shin" pos="0 0 -0.3"><joint axis="0 1 0"/><geom/>
          <body name="r_foot" pos="0 0 -0.3"><joint axis="0 1 0"/><geom/></body></body></body>
      <body name="torso"><joint name="waist" axis="0 1 0"/><geom pos="0 0 0.2"/>
        <body name="l_arm" pos="0.06 0.15 0.4"><joint axis="0 1 0"/><geom/>
          <body name="l_elbow" pos="0 0.2 0"><joint axis="0 1 0"/><geom/>
            <body name="l_hand" pos="0 0.2 0"><geom/></body></body></body>
        <body name="r_arm" pos="0.06 -0.15 0.4"><joint axis="0 1 0"/><geom/>
          <body name="r_elbow" pos="0 -0.2 0"><joint axis="0 1 0"/><geom/>
            <body name="r_hand" pos="0 -0.2 0"><geom/></body></body></body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

// Joint positions of a standing human; the shoulders are 6 cm behind the hips.
Vector3d standing_place_of(std::string_view bone) {
  const double side = bone.starts_with("Left") ? 1.0 : -1.0;
  if (bone == "Hips") return {0.0, 0.0, 1.0};
  if (bone.ends_with("UpLeg")) return {0.02, 0.1 * side, 1.0};
  if (bone.ends_with("Leg")) return {0.02, 0.1 * side, 0.5};
  if (bone.ends_with("Foot") || bone.ends_with("FootMod")) return {0.02, 0.1 * side, 0.1};
  if (bone.ends_with("Toe")) return {0.2, 0.1 * side, 0.03};
  if (bone == "Spine") return {-0.02, 0.0, 1.1};
  if (bone == "Spine1") return {-0.02, 0.0, 1.2};
  if (bone == "Spine2") return {-0.02, 0.0, 1.3};
  if (bone == "Neck") return {-0.03, 0.0, 1.6};
  if (bone == "Head") return {-0.03, 0.0, 1.7};
  if (bone.ends_with("Shoulder")) return {-0.04, 0.05 * side, 1.5};
  if (bone.ends_with("ForeArm")) return {-0.04, 0.5 * side, 1.5};
  if (bone.ends_with("Arm")) return {-0.04, 0.2 * side, 1.5};
  return {-0.04, 0.75 * side, 1.5};  // hands
}

bool of_the_trunk(std::string_view bone) {
  return bone.ends_with("UpLeg") || !(bone.ends_with("Leg") || bone.ends_with("Foot") ||
                                      bone.ends_with("FootMod") || bone.ends_with("Toe"));
}

// Rotated as a whole, and bent about the middle of the hip joints.
HumanClip human_in(int frames, const std::function<Quaterniond(int)>& turn,
                   const std::function<Quaterniond(int)>& bend) {
  HumanClip human;
  human.frame_count = frames;
  human.sources = BoneArray<std::string>("joint");
  human.world_from_bone.resize(static_cast<std::size_t>(frames));
  const Vector3d hips(0.02, 0.0, 1.0);
  for (int frame = 0; frame < frames; ++frame) {
    for (const Bone bone : kAllBones) {
      Pose& pose = human.world_from_bone[static_cast<std::size_t>(frame)][bone];
      const std::string_view name = bone_name(bone);
      Quaterniond turned = turn(frame);
      Vector3d place = standing_place_of(name) - hips;
      if (of_the_trunk(name)) {
        place = bend(frame) * place;
        turned = turned * bend(frame);
      }
      pose.translation = turn(frame) * place + hips;
      pose.rotation = turned * Quaterniond(canonical_t_pose(bone));
    }
  }
  return human;
}

// Lowers the hips of a frame and everything above; the feet stay on the floor, before the body.
void lower_hips(HumanClip& human, int frame, double by) {
  HumanPose& pose = human.world_from_bone[static_cast<std::size_t>(frame)];
  for (const Bone bone : kAllBones) {
    if (of_the_trunk(bone_name(bone))) pose[bone].translation.z() -= by;
  }
  for (const char* side : {"Left", "Right"}) {
    const auto place = [&](const char* part) -> Vector3d& {
      return pose[*bone_from_name(std::string(side) + part)].translation;
    };
    const double rise = place("UpLeg").z() - place("Foot").z();
    constexpr double kLeg = 0.9;
    const double ahead = std::sqrt(std::max(0.0, kLeg * kLeg - rise * rise));
    const Vector3d step = place("UpLeg") + Vector3d(ahead, 0.0, -rise) - place("Foot");
    place("Leg") = place("UpLeg") + Vector3d(ahead, 0.0, -rise) * (0.5 / kLeg);
    for (const char* part : {"Foot", "Toe", "FootMod"}) place(part) += step;
  }
}

Quaterniond about(const Vector3d& axis, double degrees) {
  return Quaterniond(AngleAxisd(degrees * kDegree, axis));
}

class TrunkLeanTest : public ::testing::Test {
 protected:
  // The root is rotated, the waist bent.
  QualityReport measure(const HumanClip& human, const Quaterniond& root, double waist = 0.0) const {
    RobotClip clip(robot_, {30, 1}, human.frame_count);
    const int at = robot_->joints()[robot_->find_joint("waist").value()].qpos_address;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      const auto qpos = clip.qpos(frame);
      qpos[3] = root.w();
      qpos[4] = root.x();
      qpos[5] = root.y();
      qpos[6] = root.z();
      qpos[at] = waist * kDegree;
    }
    const QualitySource source{&human, &config_, ScaleRule::kTable};
    return measure_quality(clip, robot_->model_limits(), &source);
  }
  static HumanClip standing() {
    const auto still = [](int) { return Quaterniond::Identity(); };
    return human_in(10, still, still);
  }
  static HumanClip bent(const Quaterniond& bend) {
    return human_in(
        10, [](int) { return Quaterniond::Identity(); }, [&](int) { return bend; });
  }

  const std::shared_ptr<const Robot> robot_ = robot_from_text(kLeaning);
  const ResolvedConfig config_ = resolved(limbed_config(), *robot_);
};

const MetricValue& error_of(const QualityReport& report) {
  const MetricValue* found = report.find("trunk_lean_error_deg");
  EXPECT_NE(found, nullptr);
  static const MetricValue kNone;
  return found == nullptr ? kNone : *found;
}

TEST_F(TrunkLeanTest, StandingBodiesDoNotLean) {
  const QualityReport report = measure(standing(), Quaterniond::Identity());
  EXPECT_NEAR(error_of(report).value, 0.0, 1e-9);
  ASSERT_TRUE(report.trunk_lean);
  EXPECT_NEAR(report.trunk_lean->human, 0.0, 1e-9);
  EXPECT_NEAR(report.trunk_lean->robot, 0.0, 1e-9);
  // Shoulders 6 cm behind hips that are 50 cm below, and 6 cm in front of hips that are 40 cm
  // below.
  const double human_line = std::atan2(0.06, 0.5) / kDegree;
  const double robot_line = std::atan2(0.06, 0.4) / kDegree;
  EXPECT_NEAR(report.trunk_lean->human_line, human_line, 1e-9);
  EXPECT_NEAR(report.trunk_lean->robot_line, robot_line, 1e-9);
  EXPECT_NEAR(report.trunk_lean->human_standing, human_line, 1e-9);
  EXPECT_NEAR(report.trunk_lean->robot_standing, robot_line, 1e-9);
}

TEST_F(TrunkLeanTest, MatchesTheBendInEveryDirection) {
  for (const Vector3d& axis : {Vector3d(0, 1, 0), Vector3d(0, -1, 0), Vector3d(1, 0, 0),
                               Vector3d(-1, 0, 0), Vector3d(0.6, 0.8, 0)}) {
    const QualityReport report = measure(bent(about(axis, 25.0)), about(axis, 40.0));
    ASSERT_TRUE(report.trunk_lean);
    EXPECT_NEAR(report.trunk_lean->human, 25.0, 1e-9) << axis.transpose();
    EXPECT_NEAR(report.trunk_lean->robot, 40.0, 1e-9) << axis.transpose();
    EXPECT_NEAR(error_of(report).value, 15.0, 1e-9);
    EXPECT_NEAR(error_of(report).p95.value_or(0.0), 15.0, 1e-9);
  }
}

TEST_F(TrunkLeanTest, SumsPelvisAndWaist) {
  // 10 degrees by the pelvis and 20 by the waist are the human's 30.
  const QualityReport report =
      measure(bent(about(Vector3d::UnitY(), 30.0)), about(Vector3d::UnitY(), 10.0), 20.0);
  ASSERT_TRUE(report.trunk_lean);
  EXPECT_NEAR(report.trunk_lean->robot, 30.0, 1e-9);
  EXPECT_NEAR(error_of(report).value, 0.0, 1e-9);
}

TEST_F(TrunkLeanTest, IsIndependentOfFacing) {
  const Quaterniond human_yaw = about(Vector3d::UnitZ(), 130.0);
  const HumanClip human = human_in(
      10, [&](int) { return human_yaw; }, [](int) { return about(Vector3d::UnitY(), 35.0); });
  const QualityReport report =
      measure(human, about(Vector3d::UnitZ(), -70.0) * about(Vector3d::UnitY(), 30.0));
  EXPECT_NEAR(error_of(report).value, 5.0, 1e-9);
}

TEST_F(TrunkLeanTest, IsTheMeanOverFramesAndReportsOutliers) {
  // The human bows by 0, 4, ... 36 degrees, the robot stands.
  const HumanClip human = human_in(
      10, [](int) { return Quaterniond::Identity(); },
      [](int frame) { return about(Vector3d::UnitY(), 4.0 * frame); });
  const QualityReport report = measure(human, Quaterniond::Identity());
  EXPECT_NEAR(error_of(report).value, 18.0, 1e-9);
  EXPECT_NEAR(error_of(report).p95.value_or(0.0), 34.2, 1e-9);
  const auto fault = std::ranges::find(report.faults, "trunk_lean_error_deg",
                                       [](const Fault& f) { return f.metric; });
  ASSERT_NE(fault, report.faults.end());
  EXPECT_EQ(fault->begin, 4);  // the first over 15 degrees
  EXPECT_EQ(fault->end, 10);
  EXPECT_NEAR(fault->amount, 36.0, 1e-9);
}

// Legs of 0.9 m: hips lower than 0.675 m are low.
TEST_F(TrunkLeanTest, LyingIsALeanWithLowHips) {
  double floor = 0.0;
  const auto lying_of = [&](double degrees, double height, int lying_frames = 10) {
    HumanClip human = bent(about(Vector3d::UnitY(), degrees));
    for (int frame = 0; frame < lying_frames; ++frame) lower_hips(human, frame, 1.0 - height);
    for (HumanPose& pose : human.world_from_bone) {
      for (const Bone bone : kAllBones) pose[bone].translation.z() += floor;
    }
    const QualityReport report = measure(human, Quaterniond::Identity());
    const MetricValue* found = report.find("lying_pct");
    return found == nullptr ? -1.0 : found->value;
  };
  // Heights are those above the floor on which the feet stand.
  for (const double height : {0.0, -1.0, 1.0}) {
    SCOPED_TRACE(height);
    floor = height;
    EXPECT_EQ(lying_of(0.0, 1.0), 0.0);
    EXPECT_EQ(lying_of(90.0, 1.0), 0.0);  // bends over
    EXPECT_EQ(lying_of(0.0, 0.3), 0.0);   // squats or sits
    EXPECT_EQ(lying_of(55.0, 0.5), 0.0);
    EXPECT_EQ(lying_of(65.0, 0.5), 100.0);  // crawls
    EXPECT_EQ(lying_of(-90.0, 0.2), 100.0);
    EXPECT_EQ(lying_of(90.0, 0.2, 3), 30.0);
  }
}

// Posture metrics omit lying frames, and half a second before and after.
TEST_F(TrunkLeanTest, IgnoresLyingFrames) {
  const auto lies_until = [&](int up, int frames) {
    HumanClip human = human_in(
        frames, [](int) { return Quaterniond::Identity(); },
        [up](int frame) { return about(Vector3d::UnitY(), frame < up ? 90.0 : 20.0); });
    for (int frame = 0; frame < std::min(up, frames); ++frame) lower_hips(human, frame, 0.8);
    return measure(human, Quaterniond::Identity());
  };
  const QualityReport standing = lies_until(0, 60), half = lies_until(30, 60);
  EXPECT_NEAR(error_of(standing).value, 20.0, 1e-9);
  EXPECT_NEAR(error_of(half).value, 20.0, 1e-9);
  EXPECT_EQ(half.find("lying_pct")->value, 50.0);
  ASSERT_NE(half.find("worst_limb_angle_deg"), nullptr);
  EXPECT_NEAR(half.find("worst_limb_angle_deg")->value,
              standing.find("worst_limb_angle_deg")->value, 1e-9);
  // This leaves all frames.
  EXPECT_GT(std::abs(half.find("limb_angle_deg")->value - standing.find("limb_angle_deg")->value),
            1.0);
  // 15 frames later the person still lies.
  for (const QualityReport& report : {lies_until(45, 60), lies_until(60, 60)}) {
    for (const char* key : {"trunk_lean_error_deg", "worst_limb_angle_deg", "joint_at_limit_pct",
                            "joint_frames_at_limit_pct", "at_limit_pct"}) {
      EXPECT_EQ(report.find(key), nullptr) << key;
    }
    EXPECT_NE(report.find("limb_angle_deg"), nullptr);
  }
  EXPECT_NE(lies_until(44, 60).find("trunk_lean_error_deg"), nullptr);
}

TEST_F(TrunkLeanTest, DoesNotNeedMappedHands) {
  ResolvedConfig config = config_;
  EXPECT_EQ(leave_out_bones(config, std::array{Bone::kLeftHand, Bone::kRightHand}).value(), 2);
  const HumanClip human = bent(about(Vector3d::UnitY(), 30.0));
  const QualitySource source{&human, &config, ScaleRule::kTable};
  const RobotClip clip(robot_, {30, 1}, human.frame_count);
  const QualityReport report = measure_quality(clip, robot_->model_limits(), &source);
  EXPECT_NEAR(error_of(report).value, 30.0, 1e-9);
  EXPECT_NEAR(report.leg.value_or(0.0), 0.6, 1e-9);
}

TEST_F(TrunkLeanTest, IsOmittedWithoutShoulders) {
  HumanClip human = standing();
  human.sources[Bone::kLeftArm].clear();
  const QualityReport report = measure(human, Quaterniond::Identity());
  EXPECT_EQ(report.find("trunk_lean_error_deg"), nullptr);
  EXPECT_EQ(report.find("lying_pct"), nullptr);
  EXPECT_FALSE(report.trunk_lean);
}

}  // namespace
}  // namespace retarget
