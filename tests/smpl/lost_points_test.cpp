#include "formats/smpl/joint_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kFramesWithGaps = 20;

// Three joints that move along x.
JointMotion going() {
  JointMotion motion;
  motion.frame_count = kFramesWithGaps;
  motion.joint_count = 3;
  motion.names = {"hips", "elbow", "wrist"};
  for (int frame = 0; frame < kFramesWithGaps; ++frame) {
    for (int joint = 0; joint < 3; ++joint) {
      motion.positions.emplace_back(0.01 * frame, 0.2 * joint, 1.0);
    }
  }
  return motion;
}

void lose(JointMotion& motion, int frame, int joint, double value) {
  motion.positions[motion.index(frame, joint)] = Vector3d::Constant(value);
}

TEST(LostPoints, CompleteMotionsDoNotChange) {
  JointMotion motion = going();
  bridge_lost_points(motion);
  EXPECT_EQ(motion.positions, going().positions);
  EXPECT_THAT(motion.warnings, IsEmpty());
}

TEST(LostPoints, AreBridgedAndReported) {
  for (const double lost : {0.0, -1.0, 1e6, kNan}) {
    JointMotion motion = going();
    for (const int frame : {5, 6, 7, 12}) lose(motion, frame, 2, lost);
    bridge_lost_points(motion);
    for (int frame = 0; frame < kFramesWithGaps; ++frame) {
      EXPECT_LT((motion.position(frame, 2) - going().position(frame, 2)).norm(), 1e-12) << frame;
    }
    ASSERT_EQ(motion.warnings.size(), 1U);
    EXPECT_THAT(motion.warnings[0].message, HasSubstr("4 of 20 frames"));
    EXPECT_THAT(motion.warnings[0].message, HasSubstr("wrist"));
  }
}

// Joints near the origin, which is a small jump from there.
TEST(LostPoints, AreBridgedIfSeveralAreAtTheOrigin) {
  const auto near = [](JointMotion motion) {
    for (Vector3d& place : motion.positions) place -= Vector3d(0.155, 0.25, 1.0);
    return motion;
  };
  JointMotion motion = near(going());
  for (int frame = 7; frame < 13; ++frame) {
    for (int joint = 0; joint < 3; ++joint) lose(motion, frame, joint, 0.0);
  }
  bridge_lost_points(motion);
  for (int joint = 0; joint < 3; ++joint) {
    const Vector3d apart = motion.position(10, joint) - near(going()).position(10, joint);
    EXPECT_LT(apart.norm(), 1e-12) << joint;
  }
}

TEST(LostPoints, KeepTheirNearestPlaceAtTheEnds) {
  JointMotion motion = going();
  for (const int frame : {0, 1, kFramesWithGaps - 1}) lose(motion, frame, 1, 0.0);
  bridge_lost_points(motion);
  EXPECT_EQ(motion.position(0, 1), going().position(2, 1));
  EXPECT_EQ(motion.position(1, 1), going().position(2, 1));
  EXPECT_EQ(motion.position(kFramesWithGaps - 1, 1), going().position(kFramesWithGaps - 2, 1));
  ASSERT_EQ(motion.warnings.size(), 1U);
  EXPECT_THAT(motion.warnings[0].message, HasSubstr("3 of 20 frames"));
}

// Reading reports NaN as an error.
TEST(LostPoints, StayNanAtTheEnds) {
  JointMotion motion = going();
  lose(motion, 0, 1, kNan);
  lose(motion, kFramesWithGaps - 1, 1, kNan);
  bridge_lost_points(motion);
  EXPECT_TRUE(motion.position(0, 1).array().isNaN().all());
  EXPECT_TRUE(motion.position(kFramesWithGaps - 1, 1).array().isNaN().all());
  EXPECT_THAT(motion.warnings, IsEmpty());
}

// The hips of a T-pose at the origin, and a root that starts there.
TEST(LostPoints, KeepACalibrationPoseAtTheOrigin) {
  JointMotion motion = going();
  const Vector3d hips = motion.position(0, 0);
  for (int joint = 0; joint < 3; ++joint) motion.positions[motion.index(0, joint)] -= hips;
  const auto before = motion.positions;
  bridge_lost_points(motion);
  EXPECT_EQ(motion.positions, before);
  JointMotion starting = going();
  for (int frame = 0; frame < kFramesWithGaps; ++frame) {
    starting.positions[starting.index(frame, 0)] = Vector3d(0.01 * frame, 0.0, 0.0);
  }
  const auto moving = starting.positions;
  bridge_lost_points(starting);
  EXPECT_EQ(starting.positions, moving);
}

// A person who walks passes a wrist's distance to the origin in a second.
TEST(LostPoints, OfWalkersAreBridgedUpToASecond) {
  const auto walking = [](int lost) {
    JointMotion motion;
    motion.frame_count = 200;
    motion.joint_count = 1;
    for (int frame = 0; frame < motion.frame_count; ++frame) {
      motion.positions.emplace_back(0.05 * frame - 5.0, 0.2, 1.0);
    }
    for (int frame = 85; frame < 85 + lost; ++frame) lose(motion, frame, 0, 0.0);
    return motion;
  };
  JointMotion motion = walking(30);
  EXPECT_FALSE(bridge_lost_points(motion));
  EXPECT_LT((motion.position(100, 0) - walking(0).position(100, 0)).norm(), 1e-12);
  JointMotion longer = walking(31);
  const auto gap = bridge_lost_points(longer);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->joint, 0);
  EXPECT_EQ(gap->frames.begin, 85);
  EXPECT_EQ(gap->frames.end, 116);
}

TEST(LostPoints, KeepAJointThatBelongsAtTheOrigin) {
  JointMotion motion = going();
  for (int frame = 0; frame < kFramesWithGaps; ++frame) {
    if (frame % 3 != 0) lose(motion, frame, 0, 0.0);
  }
  const auto before = motion.positions;
  bridge_lost_points(motion);
  EXPECT_EQ(motion.positions, before);
}

TEST(LostPoints, KeepAJointThatPassesTheOrigin) {
  JointMotion motion = going();
  for (int frame = 0; frame < kFramesWithGaps; ++frame) {
    motion.positions[motion.index(frame, 2)] = Vector3d(0.1 * (frame - 10), 0.0, 0.0);
  }
  const auto before = motion.positions;
  bridge_lost_points(motion);
  EXPECT_EQ(motion.positions, before);
}

}  // namespace
}  // namespace retarget
