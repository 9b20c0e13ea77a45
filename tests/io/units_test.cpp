#include "base/option_name.h"
#include "retarget/motion_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The CSV of a G1 that moves along x at a speed, in the writer's own layout, without a header.
class UnitsTest : public ::testing::Test {
 protected:
  struct Walk {
    double height = 0.76;  // of the root, metres
    double speed = 1.2;    // m/s
    double swing = 0.3;    // of every joint, rad
    double scale = 1.0;    // Scale of the written lengths.
    double angles = 1.0;   // Scale of the written angles.
    bool lying = false;    // On its back; otherwise upright.
  };
  [[nodiscard]] std::string csv(const Walk& walk) const {
    RobotClip clip(robot_, {30, 1}, 60);
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const auto qpos = clip.qpos(frame);
      qpos[0] = walk.scale * walk.speed * frame / 30.0;
      qpos[2] = walk.scale * walk.height;
      qpos[3] = std::cos(0.6);
      qpos[walk.lying ? 5 : 6] = std::sin(0.6);
      for (std::size_t i = 7; i < qpos.size(); ++i) {
        qpos[i] = walk.angles * walk.swing * std::sin(0.2 * frame + static_cast<double>(i));
      }
    }
    return format_robot_csv(clip, {.precision = 9});
  }
  [[nodiscard]] Result<RobotMotion> read(const std::string& text,
                                         ReadMotionOptions options = {}) const {
    options.quaternion = QuaternionOrder::kXyzw;
    return parse_robot_motion(text, robot_, "m.csv", options);
  }
  static ReadMotionOptions metres(double per_unit) {
    ReadMotionOptions options;
    options.metres_per_unit = per_unit;
    return options;
  }
  void expect_refused(const std::string& text, const std::string& option) const {
    const auto motion = read(text);
    ASSERT_FALSE(motion) << motion->clip.qpos(0)[2];
    EXPECT_EQ(motion.error().kind, ErrorKind::kInput);
    EXPECT_THAT(motion.error().hint, HasSubstr(option));
  }
  void expect_doubted(const std::string& text, const std::string& option) const {
    const auto motion = value_of(read(text));
    EXPECT_THAT(motion.warnings, Contains(HasSubstr(option)));
  }

  std::shared_ptr<const Robot> robot_ = load_g1();
};

TEST_F(UnitsTest, OwnFilesAreInMetresAndRadians) {
  for (const double height : {0.02, 0.08, 0.76, 2.0, 3.5}) {
    const auto motion = read(csv({.height = height, .lying = height < 0.1}));
    ASSERT_TRUE(motion) << height << ": " << describe(motion.error());
    EXPECT_NEAR(motion->clip.qpos(5)[2], height, 1e-9);
    EXPECT_NEAR(motion->clip.qpos(59)[0], 1.2 * 59 / 30.0, 1e-9);
    if (height < 1.0) {
      EXPECT_THAT(motion->warnings, IsEmpty()) << height;
    }
  }
}

// An earlier version read these as metres without a warning: a hundredth and a tenth of a walk's
// heights.
TEST_F(UnitsTest, RejectsStandingRobotsThatAreTooLow) {
  for (const double scale : {0.001, 0.01, 0.1, 0.0}) {
    expect_refused(csv({.scale = scale}), OPTION("source-unit") " m");
    const auto motion = read(csv({.scale = scale}), metres(1.0));
    ASSERT_TRUE(motion) << scale << ": " << describe(motion.error());
    EXPECT_NEAR(motion->clip.qpos(5)[2], 0.76 * scale, 1e-9);
    EXPECT_THAT(motion->warnings, IsEmpty());
    // A lying robot may be this low.
    EXPECT_TRUE(read(csv({.scale = scale, .lying = true})));
  }
}

TEST_F(UnitsTest, WarnsAboutLowOrHighStanding) {
  // Like a kneeling robot that leans back on its heels, a robot in feet, or one on a roof.
  for (const double height : {0.2, 1.4, 2.2}) {
    expect_doubted(csv({.height = height}), OPTION("source-unit"));
    EXPECT_THAT(read(csv({.height = height}), metres(1.0))->warnings, IsEmpty());
  }
  for (const double height : {0.35, 0.5, 1.2}) {
    EXPECT_THAT(read(csv({.height = height}))->warnings, IsEmpty()) << height;
  }
}

// Falls and get-ups: most upright frames are high, or few are upright.
TEST_F(UnitsTest, GettingUpIsPlausible) {
  for (const int upright_from : {10, 54}) {
    RobotClip clip(robot_, {30, 1}, 60);
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const bool upright = frame >= upright_from;
      const bool low = !upright || upright_from > 30 || frame == upright_from;
      const auto qpos = clip.qpos(frame);
      qpos[2] = low ? 0.07 : 0.7;
      qpos[3] = std::cos(upright ? 0.1 : 0.8);
      qpos[5] = std::sin(upright ? 0.1 : 0.8);
    }
    const auto motion = read(format_robot_csv(clip, {.precision = 9}));
    ASSERT_TRUE(motion) << upright_from << ": " << describe(motion.error());
    EXPECT_THAT(motion->warnings, IsEmpty()) << upright_from;
  }
}

TEST_F(UnitsTest, SittingUprightIsPlausible) {
  RobotClip clip(robot_, {30, 1}, 60);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    qpos[2] = 0.12;
    qpos[3] = 1.0;
    for (const int joint : robot_->output_joints()) {
      const RobotJoint& each = robot_->joints()[static_cast<std::size_t>(joint)];
      if (each.name.find("hip_pitch") != std::string::npos) qpos[each.qpos_address] = -1.57;
    }
  }
  const auto motion = value_of(read(format_robot_csv(clip, {.precision = 9})));
  EXPECT_THAT(motion.warnings, IsEmpty());
}

// An earlier version read these as centimetres and millimetres, a hundredth and a thousandth of
// their size.
TEST_F(UnitsTest, HighPositionsAreNotCentimetres) {
  for (const double height : {6.5, 8.0, 90.0, 1000.0}) {
    expect_refused(csv({.height = height}), OPTION("source-unit"));
    const auto motion = value_of(read(csv({.height = height}), metres(1.0)));
    EXPECT_NEAR(motion.clip.qpos(5)[2], height, 1e-9);
    EXPECT_THAT(motion.warnings, IsEmpty());
  }
}

TEST_F(UnitsTest, CentimetresAndMillimetresMustBeGiven) {
  for (const double scale : {100.0, 1000.0}) {
    expect_refused(csv({.scale = scale}), OPTION("source-unit"));
    const auto motion = value_of(read(csv({.scale = scale}), metres(1.0 / scale)));
    EXPECT_NEAR(motion.clip.qpos(5)[2], 0.76, 1e-9);
  }
}

TEST_F(UnitsTest, WarnsAboutLowCentimetres) {
  // On the back at 3 cm, and with heights relative to the first frame.
  expect_doubted(csv({.height = 0.03, .scale = 100.0, .lying = true}), OPTION("source-unit"));
  expect_doubted(csv({.height = 0.0, .scale = 100.0, .lying = true}), OPTION("source-unit"));
}

TEST_F(UnitsTest, DegreesMustBeGiven) {
  const double degrees = 180.0 / 3.14159265358979323846;
  expect_refused(csv({.angles = degrees}), OPTION("source-angles"));
  ReadMotionOptions in_degrees;
  in_degrees.degrees = true;
  const auto motion = value_of(read(csv({.angles = degrees}), in_degrees));
  EXPECT_NEAR(motion.clip.qpos(0)[8], 0.3 * std::sin(8.0), 1e-9);
  // Little movement: no number exceeds the widest joint range, but most joints exceed theirs.
  expect_doubted(csv({.swing = 0.05, .angles = degrees}), OPTION("source-angles"));
  EXPECT_THAT(read(csv({}))->warnings, IsEmpty());
}

// A robot with a folded zero configuration does not stand lower for it.
TEST_F(UnitsTest, FoldedZeroPoseIsNotSmall) {
  robot_ = robot_from_text(R"(<mujoco><worldbody><body name="pelvis"><freejoint/>
    <geom size=".1"/>
    <body name="thigh"><joint name="hip" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/>
    <body name="shin" pos=".4 0 0"><joint name="knee" axis="0 1 0"/><geom size=".1"/>
    <body name="foot" pos="-.4 0 0"><joint name="ankle" axis="0 1 0"/><geom size=".1"/>
    </body></body></body></body></worldbody></mujoco>)");
  const auto motion = value_of(read("0,0,0.8,0,0,0,1,0,0,0\n0,0,0.9,0,0,0,1,0,0,0\n"));
  EXPECT_EQ(motion.clip.qpos(1)[2], 0.9);
  EXPECT_THAT(motion.warnings, IsEmpty());
}

}  // namespace
}  // namespace retarget
