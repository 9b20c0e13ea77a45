#include "retarget/clip.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "motion/test_clips.h"

namespace retarget {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Homogeneous matrix of a joint, from its parent.
Matrix4d local_matrix(const Clip& clip, int frame, int joint) {
  Matrix4d matrix = Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = clip.rotations(frame)[joint].toRotationMatrix();
  matrix.topRightCorner<3, 1>() = clip.translation(frame, joint);
  return matrix;
}

// From the joint up to the root, in matrices: the opposite order of the function under test.
Matrix4d world_matrix(const Clip& clip, int frame, int joint) {
  Matrix4d matrix = Matrix4d::Identity();
  for (int j = joint; j >= 0; j = clip.skeleton().joint(j).parent) {
    matrix = local_matrix(clip, frame, j) * matrix;
  }
  return matrix;
}

TEST(ForwardKinematics, MatchesTheProductOfMatrices) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Clip clip(make_tree(), FrameRate{30, 1}, 20);
  for (int frame = 0; frame < 20; ++frame) {
    for (auto& q : clip.rotations(frame)) {
      q = Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    }
    for (auto& p : clip.translations(frame)) p = {normal(random), normal(random), normal(random)};
  }
  std::vector<Pose> world_from_joint(5);
  for (int frame = 0; frame < 20; ++frame) {
    forward_kinematics(clip, frame, world_from_joint);
    for (int joint = 0; joint < 5; ++joint) {
      const Matrix4d expected = world_matrix(clip, frame, joint);
      const Pose& pose = world_from_joint[joint];
      EXPECT_LE((pose.rotation.toRotationMatrix() - expected.topLeftCorner<3, 3>()).norm(), 1e-14);
      EXPECT_LE((pose.translation - expected.topRightCorner<3, 1>()).norm(), 1e-14);
    }
  }
}

TEST(ForwardKinematics, RestPoseAddsOffsets) {
  const Clip clip(make_tree(), FrameRate{30, 1}, 1);
  std::vector<Pose> world_from_joint(5);
  forward_kinematics(clip, 0, world_from_joint);
  EXPECT_LE((world_from_joint[2].translation - Vector3d(0.1, 1.6, 0.05)).norm(), 1e-15);
  EXPECT_LE((world_from_joint[4].translation - Vector3d(0.3, 0.4, -0.1)).norm(), 1e-15);
}

TEST(ForwardKinematics, ChildrenRotateWithTheirParents) {
  Clip clip(make_tree(), FrameRate{30, 1}, 1);
  // A quarter turn about z rotates the spine's offset from y to -x.
  clip.rotations(0)[0] = exp_so3({0.0, 0.0, 0.5 * std::numbers::pi});
  std::vector<Pose> world_from_joint(5);
  forward_kinematics(clip, 0, world_from_joint);
  EXPECT_LE((world_from_joint[1].translation - Vector3d(0.1 - 0.3, 0.9, 0.05)).norm(), 1e-15);
  EXPECT_LE((world_from_joint[2].translation - Vector3d(0.1 - 0.7, 0.9, 0.05)).norm(), 1e-15);
}

}  // namespace
}  // namespace retarget
