// Operations on a whole robot clip: the distance from the limits, the normalised start.

#include <gtest/gtest.h>

#include "retarget/normalize_start.h"
#include "robot/model/limits.h"
#include "support/angles.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

void set_root(RobotClip& clip, int frame, const Eigen::Vector3d& position,
              const Eigen::Quaterniond& rotation) {
  const auto qpos = clip.qpos(frame);
  for (int i = 0; i < 3; ++i) qpos[i] = position[i];
  qpos[3] = rotation.w();
  for (int i = 0; i < 3; ++i) qpos[4 + i] = rotation.vec()[i];
}

Pose root_of(const RobotClip& clip, int frame) {
  const auto q = clip.qpos(frame);
  return {Eigen::Quaterniond(q[3], q[4], q[5], q[6]), {q[0], q[1], q[2]}};
}

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

TEST(NearestLimit, ReportsJointFrameSideAndDistance) {
  const auto robot = robot_from_text(kTwoArms);
  RobotClip clip(robot, {30, 1}, 4);
  const auto set = [&](const char* joint, int frame, double q) {
    clip.qpos(frame)[robot->joints()[*robot->find_joint(joint)].qpos_address] = q;
  };
  for (int frame = 0; frame < 4; ++frame) set("left_elbow", frame, 1.0);  // range 0 to 2.5
  set("left_shoulder", 2, 1.4);                                           // range -1 to 1.5
  set("left_twist", 1, 1e6);                                              // Unlimited.
  const auto nearest = nearest_limit(clip, robot->model_limits()).value();
  EXPECT_EQ(nearest.joint, "left_shoulder");
  EXPECT_EQ(nearest.frame, 2);
  EXPECT_TRUE(nearest.at_upper);
  EXPECT_NEAR(nearest.distance, 0.1, 1e-12);
  EXPECT_EQ(nearest.frames_at_limit, 0.0);

  set("right_slide", 3, -0.25);  // range -0.2 to 0.2
  set("left_elbow", 1, 0.0005);
  const auto beyond = nearest_limit(clip, robot->model_limits());
  EXPECT_EQ(beyond->joint, "right_slide");
  EXPECT_FALSE(beyond->at_upper);
  EXPECT_NEAR(beyond->distance, -0.05, 1e-12);
  EXPECT_EQ(beyond->frames_at_limit, 0.5);
  EXPECT_FALSE(nearest_limit(RobotClip(robot, {30, 1}, 0), robot->model_limits()));
}

// The elbow's zero is its lower limit.
TEST(NearestLimit, IgnoresFixedJoints) {
  const auto robot = robot_from_text(kTwoArms);
  RobotClip clip(robot, {30, 1}, 3);
  EXPECT_FALSE(nearest_limit(clip, robot->model_limits()));
  clip.qpos(1)[7] = 1.0;
  const auto nearest = nearest_limit(clip, robot->model_limits()).value();
  EXPECT_EQ(nearest.joint, "left_shoulder");
  EXPECT_EQ(nearest.frames_at_limit, 0.0);
}

TEST(NormalizeStart, MovesTheWholeMotionRigidly) {
  const auto robot = robot_from_text(kTwoArms);
  RobotClip clip(robot, {30, 1}, 2);
  set_root(clip, 0, {3, -4, 1},
           about(Eigen::Vector3d::UnitZ(), 2.0) * about(Eigen::Vector3d::UnitY(), 0.3));
  set_root(clip, 1, {5, -4, 1.5}, about(Eigen::Vector3d::UnitX(), 0.7));
  const Pose before = root_of(clip, 0).inverse() * root_of(clip, 1);
  normalize_start(clip);
  const Pose first = root_of(clip, 0);
  EXPECT_LT((first.translation - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_NEAR(heading(first.rotation), 0.0, 1e-12);
  // The tilt does not change.
  EXPECT_LT(first.rotation.angularDistance(about(Eigen::Vector3d::UnitY(), 0.3)), 1e-7);
  const Pose after = first.inverse() * root_of(clip, 1);
  EXPECT_LT((after.translation - before.translation).norm(), 1e-12);
  EXPECT_LT(after.rotation.angularDistance(before.rotation), 1e-7);
}

TEST(Heading, IsDefinedForALyingBody) {
  const Eigen::Quaterniond face_down = about(Eigen::Vector3d::UnitY(), 0.5 * kPi);
  for (const double angle : {-2.5, 0.0, 1.0}) {
    const Eigen::Quaterniond turned = about(Eigen::Vector3d::UnitZ(), angle) * face_down;
    EXPECT_NEAR(heading(turned), angle, 1e-9);
    EXPECT_NEAR(heading(about(Eigen::Vector3d::UnitZ(), angle)), angle, 1e-12);
  }
}

TEST(NormalizeStart, HandlesAClipWithoutFrames) {
  RobotClip clip(robot_from_text(kTwoArms), {30, 1}, 0);
  normalize_start(clip);
  EXPECT_EQ(clip.frame_count(), 0);
}

}  // namespace
}  // namespace retarget
