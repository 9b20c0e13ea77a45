#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/limb_angles.h"
#include "human/skeleton/calibrate.h"
#include "human/tiny_skeleton.h"
#include "human/twins.h"
#include "retarget/plan.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// The half of a split joint that keeps the name.
enum class Named { kUpper, kLower };

// The same movement with some joints split in two at one position: the upper one takes a share of
// the rotation, the lower one the rest and all descendants.
Clip with_split_joints(const Clip& clip, const std::vector<std::string>& split, double share,
                       Named named) {
  const Skeleton& old = clip.skeleton();
  std::vector<Joint> joints;
  std::vector<int> upper(old.joint_count()), lower(old.joint_count());
  for (int i = 0; i < old.joint_count(); ++i) {
    Joint joint = old.joint(i);
    if (joint.parent >= 0) joint.parent = lower[joint.parent];
    upper[i] = lower[i] = static_cast<int>(joints.size());
    if (std::ranges::find(split, joint.name) == split.end()) {
      joints.push_back(joint);
      continue;
    }
    Joint above = joint, below = joint;
    above.end_sites.clear();
    below.parent = upper[i];
    below.offset.setZero();
    std::erase_if(below.channels, [](Channel c) { return !is_rotation(c); });
    (named == Named::kUpper ? below : above).name = "nub" + std::to_string(i);
    joints.push_back(above);
    lower[i] = static_cast<int>(joints.size());
    joints.push_back(below);
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int i = 0; i < old.joint_count(); ++i) {
      const Eigen::Quaterniond turn = clip.rotations(frame)[i];
      if (upper[i] == lower[i]) {
        twin.rotations(frame)[upper[i]] = turn;
        continue;
      }
      const Eigen::Quaterniond part = Eigen::Quaterniond::Identity().slerp(share, turn);
      twin.rotations(frame)[upper[i]] = part;
      twin.rotations(frame)[lower[i]] = (part.conjugate() * turn).normalized();
    }
    twin.translations(frame)[0] = clip.translations(frame)[0];
  }
  return twin;
}

// Largest angle in degrees between the bones of two humans.
double largest_turn_of(const HumanClip& a, const HumanClip& b) {
  double largest = 0.0;
  for (int frame = 0; frame < a.frame_count; ++frame) {
    for (const Bone bone : kAllBones) {
      largest = std::max(
          largest, a.frame(frame)[bone].rotation.angularDistance(b.frame(frame)[bone].rotation));
    }
  }
  return largest * 180.0 / M_PI;
}

// Recognition methods.
enum class Way { kProfile, kNames, kShape, kMapFile };

Result<HumanClip> human_in(const Clip& clip, Way way) {
  const auto map =
      way == Way::kMapFile
          ? Result<BoneMap>(lafan1_map(clip.skeleton(), "map file"))
          : recognise_skeleton(
                clip, way == Way::kProfile ? shipped_profiles() : std::vector<SkeletonProfile>());
  if (!map) return failure(map.error());
  const auto found = calibrate(clip, *map, {});
  if (!found) return failure(found.error());
  return to_human(clip, *found);
}

const std::vector<std::vector<std::string>>& splits() {
  static const std::vector<std::vector<std::string>> kSplits = {
      {"LeftUpLeg", "RightUpLeg"},
      {"LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"},
      {"LeftArm", "RightArm"},
      {"LeftShoulder", "RightShoulder"},
      {"LeftFoot", "RightFoot", "LeftToe", "RightToe"},
      {"LeftHand", "RightHand", "Head", "Neck"},
      {"Hips", "Spine2"},
      {"Spine", "Spine1"}};
  return kSplits;
}

void expect_same_human(const Clip& clip, Way way) {
  const auto seen = [way](const Clip& named) {
    return human_in(way == Way::kShape ? without_names(named) : named, way);
  };
  const auto expected = value_of(seen(clip));
  for (const auto& split : splits()) {
    for (const double share : {0.0, 0.5, 1.0}) {
      for (const Named named : {Named::kUpper, Named::kLower}) {
        SCOPED_TRACE("split " + split[0] + ", share " + std::to_string(share) +
                     (named == Named::kUpper ? ", name above" : ", name below"));
        const auto found = value_of(seen(with_split_joints(clip, split, share, named)));
        EXPECT_LT(largest_turn_of(found, expected), 1e-3);
      }
    }
  }
}

TEST(HelperJoints, RotateTheirBoneByNames) {
  for (const char* name : {"walk", "squat"}) {
    expect_same_human(with_t_pose_as_zero(recorded_clip(name)), Way::kNames);
  }
}

TEST(HelperJoints, RotateTheirBoneByMapFile) {
  expect_same_human(with_t_pose_as_zero(recorded_clip("walk")), Way::kMapFile);
}

// LAFAN1's own axes, which are kept.
TEST(HelperJoints, RotateTheirBoneByDialect) {
  expect_same_human(recorded_clip("walk"), Way::kProfile);
}

TEST(HelperJoints, RotateTheirBoneByShape) {
  expect_same_human(with_t_pose_as_zero(recorded_clip("walk")), Way::kShape);
}

TEST(HelperJoints, MayHavePositionChannels) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  const HumanClip expected = human_in(clip, Way::kNames).value();
  for (const double noise : {0.0, 0.001}) {
    Clip twin = with_position_channels(
        with_split_joints(clip, {"LeftArm", "RightArm", "LeftLeg"}, 0.0, Named::kUpper), noise);
    const auto found = value_of(find_human(twin, HumanOptions{}, RETARGET_SOURCE_DIR));
    EXPECT_THAT(found.calibration.doubts, testing::IsEmpty());
    EXPECT_LT(largest_turn_of(to_human(twin, found.calibration), expected), 0.1) << noise;
  }
}

// The same movement with joints inside bones, by default in the middle. They take a share of the
// bones' twist.
Clip with_twist_joints(const Clip& clip, const std::vector<std::string>& ends, double share,
                       double place_in_bone = 0.5) {
  const Skeleton& old = clip.skeleton();
  std::vector<Joint> joints;
  std::vector<int> place(old.joint_count()), twist(old.joint_count(), -1);
  for (int i = 0; i < old.joint_count(); ++i) {
    Joint joint = old.joint(i);
    if (joint.parent >= 0) joint.parent = place[joint.parent];
    if (std::ranges::find(ends, joint.name) != ends.end()) {
      Joint middle = joint;
      middle.offset *= place_in_bone;
      joint.offset *= 1.0 - place_in_bone;
      middle.name = "twist" + std::to_string(i);
      middle.end_sites.clear();
      twist[old.joint(i).parent] = static_cast<int>(joints.size());
      joint.parent = static_cast<int>(joints.size());
      joints.push_back(middle);
    }
    place[i] = static_cast<int>(joints.size());
    joints.push_back(joint);
  }
  Clip twin(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int i = 0; i < old.joint_count(); ++i) {
      const Eigen::Quaterniond turn = clip.rotations(frame)[i];
      twin.rotations(frame)[place[i]] = turn;
      if (twist[i] < 0) continue;
      const Eigen::Vector3d axis = joints[twist[i]].offset.normalized();
      Eigen::Quaterniond about(turn.w(), 0.0, 0.0, 0.0);
      about.vec() = axis * axis.dot(turn.vec());
      about = Eigen::Quaterniond::Identity().slerp(share, about.normalized());
      twin.rotations(frame)[place[i]] = (turn * about.conjugate()).normalized();
      twin.rotations(frame)[twist[i]] = about;
    }
    twin.translations(frame)[0] = clip.translations(frame)[0];
  }
  return twin;
}

const std::vector<std::string> kTwistedEnds = {"LeftForeArm", "RightForeArm", "LeftHand",
                                               "RightHand",   "LeftLeg",      "RightLeg",
                                               "LeftFoot",    "RightFoot"};

TEST(TwistJoints, TwistTheirBone) {
  for (const char* name : {"walk", "wave"}) {
    const Clip clip = with_t_pose_as_zero(recorded_clip(name));
    const HumanClip expected = human_in(clip, Way::kNames).value();
    for (const double share : {0.0, 0.5, 1.0}) {
      const auto found =
          value_of(human_in(with_twist_joints(clip, kTwistedEnds, share), Way::kNames));
      EXPECT_LT(largest_turn_of(found, expected), 0.1) << name << " " << share;
    }
  }
}

std::size_t first_joint_of(const Clip& clip, const std::string& beginning) {
  const auto& joints = clip.skeleton().joints();
  const auto found = std::ranges::find_if(
      joints, [&](const Joint& joint) { return joint.name.starts_with(beginning); });
  EXPECT_NE(found, joints.end());
  return static_cast<std::size_t>(found - joints.begin());
}

// A joint that bends a bone, as a tentacle has, does not twist it.
TEST(TwistJoints, DoNotBend) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  Clip twin = with_twist_joints(clip, {"LeftForeArm"}, 0.0);
  const std::size_t middle = first_joint_of(twin, "twist");
  for (int frame = 0; frame < twin.frame_count(); frame += 2) {
    twin.rotations(frame)[middle] =
        Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()));
  }
  const BoneMap map = recognise_skeleton(twin, {}).value();
  const Calibration found = calibrate(twin, map, {}).value();
  EXPECT_EQ(found.bones[Bone::kLeftArm].twist_joint, -1);
}

// A helper 3 cm above the knee takes half of the knee's rotation.
TEST(TwistJoints, AreNotJointsOfADoubleKnee) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  Clip twin = with_twist_joints(clip, {"LeftLeg"}, 0.0, 0.93);
  const std::size_t helper = first_joint_of(twin, "twist"), knee = helper + 1;
  const auto twist_joint = [&] {
    const BoneMap map = recognise_skeleton(twin, {}).value();
    return calibrate(twin, map, {}).value().bones[Bone::kLeftUpLeg].twist_joint;
  };
  EXPECT_EQ(twist_joint(), static_cast<int>(helper));
  for (int frame = 0; frame < twin.frame_count(); ++frame) {
    const Eigen::Quaterniond bend = std::as_const(twin).rotations(frame)[knee];
    const Eigen::Quaterniond half = Eigen::Quaterniond::Identity().slerp(0.5, bend);
    twin.rotations(frame)[helper] = half;
    twin.rotations(frame)[knee] = (half.conjugate() * bend).normalized();
  }
  EXPECT_EQ(twist_joint(), -1);
}

// Each step has a constant cost for any chain length: a search over all joints would run into the
// test's time limit.
TEST(HelperJoints, FollowChainsOfAnyLength) {
  constexpr int kCount = 300000;
  std::vector<Joint> joints(kCount + 3);
  for (int i = 0; i < kCount + 3; ++i) joints[i].parent = i - 1;
  joints[1].offset = joints[kCount + 2].offset = Eigen::Vector3d(0, -1, 0);
  BoneMap map;
  map.joint_of_bone[Bone::kHips] = 0;
  map.joint_of_bone[Bone::kLeftUpLeg] = 1;
  map.joint_of_bone[Bone::kLeftLeg] = kCount + 2;
  const Skeleton skeleton(std::move(joints));
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kLeftUpLeg), kCount + 1);
  EXPECT_EQ(rotation_joint(map, skeleton, Bone::kLeftLeg), kCount + 2);
}

}  // namespace
}  // namespace retarget
