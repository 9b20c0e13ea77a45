// Clips from robot motions: exactly the bones, lengths and soles of their source.

#include "human/skeleton/robot_human.h"

#include <gtest/gtest.h>

#include <cmath>

#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {
namespace {

Pose posed(Bone bone, const Eigen::Vector3d& place, double turn) {
  const Eigen::AngleAxisd about(turn, Eigen::Vector3d(0.3, -0.5, 0.8).normalized());
  return {Eigen::Quaterniond(about * canonical_t_pose(bone)), place};
}

// Bones at various positions; only the knees are fixed.
HumanPose pose_at(double turn) {
  HumanPose pose;
  for (const Bone bone : kMappedBones) {
    const double i = static_cast<double>(bone);
    pose[bone] = posed(bone, {std::sin(i + turn), 0.1 * i, std::cos(i) + turn}, turn * (1.0 + i));
  }
  for (const Side side : kSides) {
    const Pose& thigh = pose[side_bone(side, LimbBone::kUpLeg)];
    const Eigen::Matrix3d axes = canonical_t_pose(side_bone(side, LimbBone::kUpLeg));
    pose[side_bone(side, LimbBone::kLeg)].translation =
        thigh.translation + thigh.rotation * (axes.transpose() * Eigen::Vector3d(0.0, 0.0, -0.4));
  }
  return pose;
}

RobotHuman some_human() {
  RobotHuman human;
  human.robot = "other_robot";
  human.rate = {60, 1};
  human.frame_count = 5;
  human.poses = [](int frame, HumanPose& pose) { pose = pose_at(0.1 * frame); };
  human.standing = pose_at(0.0);
  human.has = BoneArray<bool>(true);
  human.soles[0] = FootSole{{{-0.05, -0.04, 0.01}, {-0.06, -0.04, 0.01}},
                            {{0.1, -0.04, 0.0}, {0.13, -0.04, 0.0}}};
  return human;
}

TEST(RobotHuman, RoundTripsItsBones) {
  const RobotHuman human = some_human();
  const Clip clip = clip_of_robot_human(human, "clip");
  ASSERT_TRUE(is_of_robot(clip));
  EXPECT_EQ(clip.name(), "clip");
  EXPECT_EQ(clip.origin().robot, "other_robot");
  EXPECT_EQ(clip.rate(), human.rate);
  const BoneMap map = bone_map_of_robot(clip);
  EXPECT_EQ(map.mapped_count(), static_cast<int>(kMappedBoneCount));
  const HumanClip back = to_human(clip, calibration_of_robot(clip, map));
  ASSERT_EQ(back.frame_count, 5);
  for (int frame = 0; frame < 5; ++frame) {
    const HumanPose wanted = pose_at(0.1 * frame);
    for (const Bone bone : kMappedBones) {
      const Pose& found = back.frame(frame)[bone];
      EXPECT_LT((found.translation - wanted[bone].translation).norm(), 1e-12) << bone_name(bone);
      EXPECT_LT(1.0 - std::abs(found.rotation.dot(wanted[bone].rotation)), 1e-12)
          << bone_name(bone);
    }
    // The synthetic feet are at the ankle and rotate with the toe.
    const Pose& sole = back.frame(frame)[Bone::kLeftFootMod];
    EXPECT_EQ(sole.translation, back.frame(frame)[Bone::kLeftFoot].translation);
    EXPECT_EQ(sole.rotation.coeffs(), back.frame(frame)[Bone::kLeftToe].rotation.coeffs());
  }
}

TEST(RobotHuman, MovesOnlyMovingJoints) {
  const Clip clip = clip_of_robot_human(some_human(), "clip");
  const auto has_places = [&](const char* joint) {
    return clip.skeleton().joint(*clip.skeleton().find(joint)).has_position_channels();
  };
  EXPECT_TRUE(has_places("Hips"));
  EXPECT_TRUE(has_places("LeftHand"));
  EXPECT_FALSE(has_places("LeftLeg"));
  EXPECT_FALSE(has_places("RightLeg"));
}

TEST(RobotHuman, OmitsMissingBones) {
  RobotHuman human = some_human();
  for (const Bone bone : {Bone::kLeftShoulder, Bone::kRightShoulder, Bone::kSpine1}) {
    human.has[bone] = false;
  }
  const Clip clip = clip_of_robot_human(human, "clip");
  const Skeleton& skeleton = clip.skeleton();
  EXPECT_FALSE(skeleton.find("LeftShoulder"));
  EXPECT_EQ(skeleton.joint(*skeleton.find("LeftArm")).parent, *skeleton.find("Spine2"));
  EXPECT_EQ(skeleton.joint(*skeleton.find("Spine2")).parent, *skeleton.find("Spine"));
  const HumanClip back = to_human(clip, calibration_of_robot(clip, bone_map_of_robot(clip)));
  EXPECT_FALSE(back.has(Bone::kSpine1));
  EXPECT_LT((back.frame(3)[Bone::kLeftHand].translation - pose_at(0.3)[Bone::kLeftHand].translation)
                .norm(),
            1e-12);
}

TEST(RobotHuman, KeepsKnownSoles) {
  RobotHuman human = some_human();
  // The toe is at the toe of the sole.
  human.poses = [](int, HumanPose& pose) {
    pose = pose_at(0.0);
    for (const Bone bone : kMappedBones)
      pose[bone].rotation = Eigen::Quaterniond(canonical_t_pose(bone));
    pose[Bone::kLeftToe].translation =
        pose[Bone::kLeftFoot].translation +
        canonical_t_pose(Bone::kLeftFootMod) * Eigen::Vector3d(0.1, -0.04, 0.0);
  };
  human.poses(0, human.standing);
  const Clip clip = clip_of_robot_human(human, "clip");
  const Calibration found = calibration_of_robot(clip, bone_map_of_robot(clip));
  EXPECT_FALSE(found.soles[1]);
  ASSERT_TRUE(found.soles[0]);
  EXPECT_LT((found.soles[0]->heel.middle - human.soles[0]->heel.middle).norm(), 1e-12);
  EXPECT_LT((found.soles[0]->heel.tip - human.soles[0]->heel.tip).norm(), 1e-12);
  EXPECT_LT((found.soles[0]->toe.middle - human.soles[0]->toe.middle).norm(), 1e-12);
  EXPECT_LT((found.soles[0]->toe.tip - human.soles[0]->toe.tip).norm(), 1e-12);
}

TEST(RobotHuman, RejectsHumanClips) {
  EXPECT_FALSE(
      is_of_robot(Clip(std::make_shared<const Skeleton>(std::vector<Joint>(1)), {30, 1}, 2)));
}

}  // namespace
}  // namespace retarget
