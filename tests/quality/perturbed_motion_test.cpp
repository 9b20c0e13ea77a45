// Metrics that separate a displaced, delayed or bent motion from one that follows its source, in
// cases with a known solution.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "judge/quality/joint_offset_metric.h"
#include "judge/quality/similarity_metrics.h"
#include "retarget/kinematic_tree.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kPerturbedFps = 30.0;

// A limb that swings in a plane, by an angle that does not repeat within seconds.
Vector3d swinging(double time) {
  const double angle = std::sin(3.1 * time) + 0.5 * std::sin(5.3 * time + 1.0);
  return {std::cos(angle), std::sin(angle), 0.0};
}

LimbDirections limb_late_by(double seconds, int frames) {
  LimbDirections limb;
  for (int frame = 0; frame < frames; ++frame) {
    limb.human.push_back(swinging(frame / kPerturbedFps));
    limb.robot.push_back(0.4 * swinging(frame / kPerturbedFps - seconds));
  }
  return limb;
}

TEST(LimbLag, EqualsTheDelayOfTheRobot) {
  EXPECT_NEAR(limb_lag({limb_late_by(0.0, 120)}, kPerturbedFps).value(), 0.0, 1e-3);
  EXPECT_NEAR(limb_lag({limb_late_by(4 / kPerturbedFps, 120)}, kPerturbedFps).value(),
              4 / kPerturbedFps, 2e-3);
  EXPECT_NEAR(limb_lag({limb_late_by(-7 / kPerturbedFps, 120)}, kPerturbedFps).value(),
              -7 / kPerturbedFps, 2e-3);
  // Between frames.
  EXPECT_NEAR(limb_lag({limb_late_by(2.5 / kPerturbedFps, 120)}, kPerturbedFps).value(),
              2.5 / kPerturbedFps, 3e-3);
}

TEST(LimbLag, IsTheDelayNearestToZeroForPeriodicMovement) {
  LimbDirections limb;
  for (int frame = 0; frame < 120; ++frame) {
    const double angle = std::sin(2.0 * std::numbers::pi * frame / 12.0);
    limb.human.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  limb.robot = limb.human;
  EXPECT_NEAR(limb_lag({limb}, kPerturbedFps).value(), 0.0, 1e-9);
}

TEST(LimbLag, RequiresMovementDurationAndSimilarity) {
  EXPECT_FALSE(limb_lag({limb_late_by(0.0, 29)}, kPerturbedFps));
  EXPECT_TRUE(limb_lag({limb_late_by(0.0, 30)}, kPerturbedFps));
  EXPECT_FALSE(limb_lag({}, kPerturbedFps));
  LimbDirections still = limb_late_by(0.0, 120), other = still;
  for (Vector3d& direction : still.human) direction = Vector3d::UnitX();
  EXPECT_FALSE(limb_lag({still}, kPerturbedFps));
  // Rotates about another axis.
  for (Vector3d& direction : other.human) direction = {1.0, 0.1 * direction.y(), 0.0};
  for (Vector3d& direction : other.robot) direction = {1.0, 0.0, 0.1 * direction.y()};
  EXPECT_FALSE(limb_lag({other}, kPerturbedFps));
}

TEST(RootSlide, EqualsTheRemainingSpeed) {
  std::vector<Vector3d> wanted, carried, swaying, raised;
  for (int frame = 0; frame < 91; ++frame) {
    const double time = frame / kPerturbedFps;
    wanted.emplace_back(1.2 * time, std::sin(time), 0.8);
    carried.push_back(wanted.back() + time * Vector3d(0.03, -0.04, 0.0));
    // It returns in a quarter of a second by as much as it moved in the previous one.
    swaying.push_back(wanted.back() +
                      0.1 * std::sin(2.0 * std::numbers::pi * time) * Vector3d::UnitY());
    raised.push_back(wanted.back() + (0.5 + 0.2 * time) * Vector3d::UnitZ());
  }
  EXPECT_NEAR(root_slide(carried, wanted, kPerturbedFps).value(), 0.05, 1e-12);
  EXPECT_NEAR(root_slide(swaying, wanted, kPerturbedFps).value(), 0.0, 1e-12);
  EXPECT_NEAR(root_slide(raised, wanted, kPerturbedFps).value(), 0.0, 1e-12);
  // Less than two seconds: from end to end.
  carried.resize(4);
  EXPECT_NEAR(root_slide(carried, wanted, kPerturbedFps).value(), 0.05, 1e-12);
  carried.resize(1);
  EXPECT_FALSE(root_slide(carried, wanted, kPerturbedFps));
}

// An arm that hangs from a shoulder: pitch, twist and elbow, then a wrist that moves no limb.
constexpr const char* kArm = R"(
<mujoco>
  <compiler angle="radian" inertiafromgeom="true"/>
  <default><geom size="0.02" mass="1"/></default>
  <worldbody>
    <body name="base" pos="0 0 1"><freejoint/><geom/>
      <body name="pitch"><joint name="pitch" axis="0 1 0" range="-3 3"/><geom/>
        <body name="upper"><joint name="twist" axis="0 0 1" range="-3 3"/><geom/>
          <body name="fore" pos="0 0 -0.3"><joint name="elbow" axis="0 1 0" range="-2 0.5"/><geom/>
            <body name="hand" pos="0 0 -0.2"><joint name="wrist" axis="0 0 1" range="-3 3"/><geom/></body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

class JointOffsets : public ::testing::Test {
 protected:
  static constexpr int kFrames = 6;

  void SetUp() override {
    for (int frame = 0; frame < kFrames; ++frame) set(frame, "elbow", -0.7);
  }
  [[nodiscard]] int joint(std::string_view name) const { return robot_->find_joint(name).value(); }
  void set(int frame, std::string_view name, double position) {
    clip_.qpos(frame)[robot_->joints()[joint(name)].qpos_address] = position;
  }
  // Current directions of limbs and hand of the motion.
  [[nodiscard]] std::vector<Vector3d> pointing(const std::array<LimbEnd, 2>& from,
                                               const std::array<LimbEnd, 2>& to) const {
    std::vector<Vector3d> directions;
    TreeState state(robot_->tree());
    for (int frame = 0; frame < kFrames; ++frame) {
      state.update(clip_.qpos(frame));
      const auto place = [&](const LimbEnd& end) -> Vector3d {
        return state.world_from_body(end.body) * end.body_from_joint;
      };
      directions.push_back(place(to[0]) + place(to[1]) - place(from[0]) - place(from[1]));
    }
    return directions;
  }
  [[nodiscard]] LimbDirections limb(const char* from, const char* to, int rank,
                                    const Vector3d& in_body = Vector3d::Zero()) const {
    LimbDirections limb;
    const LimbEnd begin{robot_->find_body(from).value(), Vector3d::Zero()};
    const LimbEnd end{robot_->find_body(to).value(), in_body};
    limb.from = {begin, begin};
    limb.to = {end, end};
    limb.rank = rank;
    limb.human = pointing(limb.from, limb.to);
    return limb;
  }
  // The human in the robot's current pose.
  void keep_human() {
    limbs_ = {limb("upper", "fore", 1), limb("fore", "hand", 2)};
    hands_ = {limb("hand", "hand", 0, Vector3d::UnitX()),
              limb("hand", "hand", 0, Vector3d::UnitY())};
  }
  void take_robot() {
    for (auto* all : {&limbs_, &hands_}) {
      for (LimbDirections& limb : *all) limb.robot = pointing(limb.from, limb.to);
    }
  }
  [[nodiscard]] double offset_of(std::string_view name,
                                 const std::vector<LimbDirections>& limbs) const {
    for (const JointOffset& found : find_joint_offsets(clip_, robot_->model_limits(), limbs)) {
      if (found.joint == joint(name)) return found.offset;
    }
    return std::nan("");
  }

  const std::shared_ptr<const Robot> robot_ = robot_from_text(kArm);
  RobotClip clip_{robot_, {30, 1}, kFrames};
  std::vector<LimbDirections> limbs_, hands_;
};

TEST_F(JointOffsets, MatchTheAppliedRotations) {
  keep_human();
  for (int frame = 0; frame < kFrames; ++frame) set(frame, "pitch", 0.2);
  take_robot();
  EXPECT_NEAR(offset_of("pitch", limbs_), std::sin(0.2), 1e-9);
  // The elbow accounts for a part of its descendants' error.
  EXPECT_NEAR(offset_of("elbow", limbs_), std::sin(0.2), 1e-9);
  // The twist of a hanging arm does not move its upper part, and the wrist moves no limb.
  EXPECT_TRUE(std::isnan(offset_of("twist", limbs_)));
  EXPECT_TRUE(std::isnan(offset_of("wrist", limbs_)));
}

TEST_F(JointOffsets, AreMeasuredPerJoint) {
  keep_human();
  for (int frame = 0; frame < kFrames; ++frame) {
    set(frame, "elbow", -0.9);
    set(frame, "wrist", 0.3);
  }
  take_robot();
  EXPECT_NEAR(offset_of("pitch", limbs_), 0.0, 1e-9);
  EXPECT_NEAR(offset_of("elbow", limbs_), -std::sin(0.2), 1e-9);
  EXPECT_NEAR(offset_of("wrist", hands_), std::sin(0.3), 0.1 * std::sin(0.3));
}

TEST_F(JointOffsets, AreConstantAngles) {
  keep_human();
  // Equally to both sides, and back.
  for (int frame = 0; frame < kFrames; ++frame) set(frame, "elbow", -0.7 + 0.2 * (frame % 3 - 1));
  take_robot();
  EXPECT_NEAR(offset_of("elbow", limbs_), 0.0, 1e-9);
}

TEST(JointOffsetWeights, DecreaseIfBothArmsDeviate) {
  const std::vector<std::pair<int, int>> pairs = {{1, 2}, {3, 4}, {5, 6}};
  const std::vector<JointOffset> offsets = {{0, -0.1}, {1, 0.2},  {2, -0.18},
                                            {3, 0.2},  {4, 0.02}, {5, 0.3}};
  const std::vector<double> weights = weigh_offsets(offsets, pairs);
  const std::vector<double> expected = {0.1, 0.1, 0.09, 0.18, 0.01, 0.3};
  ASSERT_EQ(weights.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(weights[i], expected[i], 1e-12) << i;
}

TEST_F(JointOffsets, IgnoreJointsAtTheFloorOrALimit) {
  keep_human();
  for (int frame = 0; frame < kFrames; ++frame) set(frame, "elbow", -0.9);
  take_robot();
  limbs_[1].free = {1, 1, 0, 0, 0, 0};
  EXPECT_TRUE(std::isnan(offset_of("elbow", limbs_)));
  limbs_[1].free = {1, 1, 1, 1, 1, 1};
  EXPECT_NEAR(offset_of("elbow", limbs_), -std::sin(0.2), 1e-9);
  for (int frame = 0; frame < kFrames; ++frame) set(frame, "elbow", 0.49);
  take_robot();
  EXPECT_TRUE(std::isnan(offset_of("elbow", limbs_)));
}

}  // namespace
}  // namespace retarget
