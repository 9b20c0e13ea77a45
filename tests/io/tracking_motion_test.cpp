#include "retarget/motion_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "formats/containers/npz.h"
#include "retarget/so3.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// All joints and the root in motion, as smooth functions of time.
RobotClip moving_clip(const std::shared_ptr<const Robot>& robot, int frames, double fps) {
  RobotClip clip(robot, frame_rate_from_fps(fps), frames);
  for (int frame = 0; frame < frames; ++frame) {
    const double t = frame / fps;
    const auto qpos = clip.qpos(frame);
    const Eigen::Quaterniond turn = exp_so3({0.4 * std::sin(t), 0.3 * t, 0.2 * std::cos(2 * t)});
    qpos[0] = 0.5 * t;
    qpos[1] = std::sin(t);
    qpos[2] = 1.0 + 0.1 * std::cos(3 * t);
    qpos[3] = turn.w();
    for (int i = 0; i < 3; ++i) qpos[4 + i] = turn.vec()[i];
    for (std::size_t i = 7; i < qpos.size(); ++i) {
      qpos[i] = 0.3 * std::sin(2 * t + static_cast<double>(i));
    }
  }
  return clip;
}

TEST(TrackingMotionTest, VelocitiesMatchTheBodies) {
  const auto robot = robot_from_text(kTwoArms);
  // The samples are so dense that differences of positions are velocities.
  const RobotClip clip = moving_clip(robot, 400, 1000.0);
  TrackingOptions options;
  options.rate = {1000, 1};
  const auto motion = value_of(make_tracking_motion(clip, MotionFormat::kNpzMjlab, options));
  ASSERT_EQ(motion.frames, 399U);
  const std::size_t bodies = motion.body_names.size();
  ASSERT_EQ(bodies, 4U);
  for (std::size_t frame = 1; frame + 1 < motion.frames; frame += 7) {
    for (std::size_t b = 0; b < bodies; ++b) {
      const std::size_t at = frame * bodies + b;
      for (std::size_t i = 0; i < 3; ++i) {
        const double difference = 500.0 * (motion.body_pos[3 * (at + bodies) + i] -
                                           motion.body_pos[3 * (at - bodies) + i]);
        EXPECT_NEAR(motion.body_lin_vel[3 * at + i], difference, 1e-5) << frame << " " << b;
      }
      const auto rotation = [&](std::size_t k) {
        const double* q = motion.body_quat.data() + 4 * k;
        return Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
      };
      const Eigen::Vector3d turn =
          500.0 * log_so3(rotation(at + bodies) * rotation(at - bodies).conjugate());
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(motion.body_ang_vel[3 * at + static_cast<std::size_t>(i)], turn[i], 1e-5);
      }
    }
  }
}

TEST(TrackingMotionTest, HasTheRightJointAndBodyOrder) {
  const auto robot = robot_from_text(kTwoArms);
  const RobotClip clip = moving_clip(robot, 30, 30.0);
  const auto deep = make_tracking_motion(clip, MotionFormat::kNpzMjlab);
  const auto broad = make_tracking_motion(clip, MotionFormat::kNpzBeyondMimic);
  ASSERT_TRUE(deep && broad);
  EXPECT_THAT(deep->body_names, ElementsAre("base", "left_upper", "left_lower", "right_upper"));
  EXPECT_THAT(broad->body_names, ElementsAre("base", "left_upper", "right_upper", "left_lower"));
  EXPECT_THAT(deep->joint_names, ElementsAre("left_shoulder", "left_elbow", "left_twist",
                                             "right_slide", "right_shoulder"));
  EXPECT_THAT(broad->joint_names, ElementsAre("left_shoulder", "right_slide", "right_shoulder",
                                              "left_elbow", "left_twist"));
  // 29 steps of 1/30 s contain 48 1/3 steps of 1/50 s: samples 0 to 48.
  EXPECT_EQ(deep->frames, 49U);
  EXPECT_EQ(broad->joint_pos[1], deep->joint_pos[3]);
}

TEST(TrackingMotionTest, ExcludesTheEndAndRejectsShortMotions) {
  const auto robot = robot_from_text(kTwoArms);
  // The last of 31 frames is at 1 s: samples 0 to 0.98 s.
  EXPECT_EQ(make_tracking_motion(moving_clip(robot, 31, 30.0), MotionFormat::kNpzMjlab)->frames,
            50U);
  // A conversion at the same rate keeps the last frame; at another rate it is the same as a run.
  for (const auto& [fps, kept] : {std::pair(50.0, 31), std::pair(30.0, 50)}) {
    const RobotClip clip = moving_clip(robot, 31, fps);
    const TrackingOptions options = conversion_options({}, clip.rate());
    EXPECT_EQ(make_tracking_motion(clip, MotionFormat::kNpzMjlab, options)->frames,
              static_cast<std::size_t>(kept));
    EXPECT_EQ(format_frame_count(clip, MotionFormat::kNpzMjlab, options), kept);
  }
  const RobotClip fast = moving_clip(robot, 31, 50.0);
  EXPECT_EQ(stored_clip(fast, MotionFormat::kNpzMjlab).frame_count(), 30);
  EXPECT_EQ(stored_clip(fast, MotionFormat::kCsvSonic).frame_count(), 31);
  EXPECT_EQ(stored_clip(fast, MotionFormat::kNpzMjlab).qpos(7)[8],
            static_cast<float>(fast.qpos(7)[8]));
  for (const int frames : {1, 2}) {
    const auto none =
        make_tracking_motion(moving_clip(robot, frames, 30.0), MotionFormat::kNpzMjlab);
    ASSERT_FALSE(none);
    EXPECT_THAT(describe(none.error()), HasSubstr("needs three frames at 50 fps"));
  }
}

TEST(TrackingMotionTest, CentreOfMassIncludesFixedBodies) {
  const auto robot = robot_from_text(R"(
<mujoco><worldbody><body name="base" pos="0 0 1"><freejoint/>
  <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
  <body name="arm" pos="0 0 0"><joint name="turn" axis="0 0 1"/>
    <inertial pos="1 0 0" mass="1" diaginertia="1 1 1"/>
    <body name="hand" pos="3 0 0"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
  </body></body></worldbody></mujoco>)");
  RobotClip clip(robot, {50, 1}, 20);
  for (int frame = 0; frame < 20; ++frame) clip.qpos(frame)[7] = 0.02 * frame;  // 1 rad/s
  TrackingOptions options;
  options.velocity_of = BodyPoint::kMass;
  const auto motion = value_of(make_tracking_motion(clip, MotionFormat::kNpzMjlab, options));
  EXPECT_THAT(motion.body_names, ElementsAre("base", "arm"));
  // The common centre of arm and hand is at 2 m: it moves at 2 m/s along y in the first frame.
  EXPECT_NEAR(motion.body_lin_vel[3 + 1], 2.0, 1e-9);
  options.velocity_of = BodyPoint::kLink;
  EXPECT_NEAR(make_tracking_motion(clip, MotionFormat::kNpzMjlab, options)->body_lin_vel[3 + 1],
              0.0, 1e-9);
}

TEST(TrackingMotionTest, FileContainsTheArrays) {
  const auto robot = robot_from_text(kTwoArms);
  const auto motion =
      value_of(make_tracking_motion(moving_clip(robot, 30, 30.0), MotionFormat::kNpzBeyondMimic));
  const auto bytes = value_of(format_tracking_npz(motion));
  const auto npz = value_of(NpzFile::open(bytes, "x.npz"));
  EXPECT_THAT(npz.read("body_quat_w")->shape, ElementsAre(49, 4, 4));
  EXPECT_EQ(npz.type_of("body_quat_w").value(), "<f4");
  EXPECT_THAT(npz.read("fps")->numbers(), ElementsAre(50));
  EXPECT_EQ(npz.type_of("fps").value(), "<i8");
  EXPECT_THAT(npz.read("flavour")->texts(), ElementsAre("npz-beyondmimic"));
  EXPECT_THAT(npz.read("body_names")->texts(),
              ElementsAre("base", "left_upper", "right_upper", "left_lower"));
  EXPECT_EQ(*format_tracking_npz(motion), bytes);
}

}  // namespace
}  // namespace retarget
