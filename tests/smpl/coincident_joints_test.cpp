#include "formats/smpl/joint_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace retarget {
namespace {

// Four coincident joints, as the hips of CMU's skeletons, and two others, relative to the first
// joint in the first frame. All joints move after that frame.
JointMotion coincident_hips() {
  JointMotion motion;
  motion.frame_count = 20;
  motion.joint_count = 6;
  motion.names = {"hips", "left_hip_joint", "right_hip_joint", "lower_back", "head", "hand"};
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    const Eigen::Vector3d hips(frame == 0 ? 0.0 : 0.01, 0.0, 0.0);
    for (int joint = 0; joint < 4; ++joint) motion.positions.push_back(hips);
    motion.positions.emplace_back(hips + Eigen::Vector3d(0.0, 0.0, 0.7));
    motion.positions.emplace_back(hips + Eigen::Vector3d(0.0, 0.3, 0.1));
  }
  return motion;
}

TEST(CoincidentJoints, AreNotLostAtTheOrigin) {
  JointMotion motion = coincident_hips();
  bridge_lost_points(motion);
  EXPECT_EQ(motion.positions, coincident_hips().positions);
  EXPECT_THAT(motion.warnings, testing::IsEmpty());
}

TEST(CoincidentJoints, AreLostTogetherWithOthers) {
  JointMotion motion = coincident_hips();
  for (int joint = 0; joint < motion.joint_count; ++joint) {
    motion.positions[motion.index(10, joint)].setZero();
  }
  bridge_lost_points(motion);
  for (int joint = 0; joint < motion.joint_count; ++joint) {
    EXPECT_LT((motion.position(10, joint) - motion.position(9, joint)).norm(), 1e-12) << joint;
  }
}

}  // namespace
}  // namespace retarget
