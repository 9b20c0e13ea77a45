#include "edit/transfer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "edit_sample.h"
#include "formats/bvh/read_bvh.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "human/twins.h"
#include "retarget/edit.h"
#include "support/recorded_clip.h"
#include "support/shared_data.h"

namespace retarget {
namespace {

std::string source_folder() {
  return RETARGET_SOURCE_DIR;
}

const std::vector<SkeletonProfile>& profiles() {
  static const std::vector<SkeletonProfile> kProfiles =
      load_skeleton_profiles(source_folder() + "/configs/skeletons").value();
  return kProfiles;
}

TransferTarget understood(const Clip& clip) {
  const BoneMap map = recognise_skeleton(clip, profiles()).value();
  return {clip.shared_skeleton(), map, calibrate(clip, map, {}).value()};
}

HumanClip human_of(const Clip& clip, const TransferTarget& target) {
  return to_human(clip, target.calibration);
}

TEST(Transfer, SameSkeletonIsIdentity) {
  for (const char* name : {"walk", "get_up"}) {
    const Clip clip = recorded_clip(name);
    const TransferTarget target = understood(clip);
    const Clip same = transfer(clip, target.calibration, target);
    ASSERT_EQ(same.frame_count(), clip.frame_count());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      EXPECT_LT((same.translation(frame, 0) - clip.translation(frame, 0)).norm(), 1e-9);
      for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
        ASSERT_GT(std::abs(same.rotations(frame)[joint].dot(clip.rotations(frame)[joint])),
                  1.0 - 1e-12);
      }
    }
  }
}

// A body of half the size walks half the distance, with the same heading.
TEST(Transfer, ScalesThePathBySize) {
  const Clip clip = recorded_clip("walk");
  const TransferTarget whole = understood(clip);
  TransferTarget target = whole;
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) {
    joint.offset *= 0.5;
    for (Eigen::Vector3d& end : joint.end_sites) end *= 0.5;
  }
  target.skeleton = std::make_shared<const Skeleton>(joints);
  target.calibration.size *= 0.5;
  const Clip half = transfer(clip, whole.calibration, target);
  EXPECT_LT((half.translation(100, 0) - 0.5 * clip.translation(100, 0)).norm(), 1e-9);
  EXPECT_LT(half.rotations(100)[3].angularDistance(clip.rotations(100)[3]), 1e-7);
}

// A joint directly below another, as its first child.
void insert_below(std::vector<Joint>& joints, int parent, Joint joint) {
  for (Joint& other : joints) {
    if (other.parent > parent) ++other.parent;
  }
  joint.parent = parent;
  joints.insert(joints.begin() + parent + 1, std::move(joint));
}

int index_of(const std::vector<Joint>& joints, const std::string& name) {
  const auto found = std::ranges::find(joints, name, &Joint::name);
  return static_cast<int>(found - joints.begin());
}

// The walk on a skeleton with a finger, a second neck joint, a moving helper and one at a hip that
// takes a part of its rotation; all of them rotate.
Clip walk_with_more_joints() {
  using enum Channel;
  const Clip walk = recorded_clip("walk");
  std::vector<Joint> joints = walk.skeleton().joints();
  const std::vector<Channel> turns{kZRotation, kYRotation, kXRotation};
  insert_below(joints, index_of(joints, "LeftHand"), {"LeftIndex1", -1, {8, 1, 0}, {}, turns});
  insert_below(joints, index_of(joints, "LeftIndex1"),
               {"LeftIndex2", -1, {4, 0, 0}, {{3, 0, 0}}, turns});
  const int neck = index_of(joints, "Neck"), head = index_of(joints, "Head");
  insert_below(joints, neck, {"Neck2", -1, 0.5 * joints[head].offset, {}, turns});
  joints[head + 1].parent = neck + 1;
  joints[head + 1].offset *= 0.5;
  const int hip = index_of(joints, "LeftUpLeg");
  insert_below(joints, hip, {"LeftHip", -1, {0, 0, 0}, {}, turns});
  joints[index_of(joints, "LeftLeg")].parent = hip + 1;
  insert_below(joints, index_of(joints, "Spine2"),
               {"Bag",
                -1,
                {-5, -9, 2},
                {{0, 4, 0}},
                {kXPosition, kYPosition, kZPosition, kZRotation, kYRotation, kXRotation}});
  Clip clip(std::make_shared<const Skeleton>(joints), walk.rate(), walk.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto rotations = clip.rotations(frame);
    for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
      if (const auto twin = walk.skeleton().find(joints[joint].name)) {
        rotations[joint] = walk.rotations(frame)[*twin];
      } else {
        rotations[joint] =
            Eigen::AngleAxisd(0.01 * (frame % 90), Eigen::Vector3d(1, 2, 3).normalized());
      }
    }
    rotations[hip] = rotations[hip] * rotations[hip + 1].conjugate();
    clip.translations(frame)[0] = walk.translations(frame)[0];
    clip.translations(frame)[1].x() += 0.02 * frame;
  }
  return clip;
}

TEST(Transfer, CopiesSharedJoints) {
  const Clip clip = walk_with_more_joints();
  const TransferTarget same = understood(clip);
  EXPECT_LT(edit_test::largest_distance(transfer(clip, same.calibration, same), clip, 0.01), 1e-9);
  // The same positions on a skeleton with rotated axes.
  const Eigen::Quaterniond axes(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) {
    joint.offset = axes * joint.offset;
    for (Eigen::Vector3d& end : joint.end_sites) end = axes * end;
  }
  TransferTarget turned{std::make_shared<const Skeleton>(joints), same.map, same.calibration};
  for (BoneSource& bone : turned.calibration.bones) {
    if (bone.rotation_joint >= 0) bone.joint_from_bone = axes;
  }
  const Clip other = transfer(clip, same.calibration, turned);
  std::vector<Pose> is(joints.size()), was(joints.size());
  for (int frame = 0; frame < clip.frame_count(); frame += 25) {
    forward_kinematics(other, frame, is);
    forward_kinematics(clip, frame, was);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      ASSERT_LT((is[i].translation - was[i].translation).norm(), 1e-9) << joints[i].name;
    }
  }
  const UncarriedJoints none = uncarried_joints(clip, same.calibration, turned);
  EXPECT_TRUE(none.left_out.empty() && none.at_rest.empty());
}

// The last helper at the position of a joint rotates the bone, on either side.
TEST(Transfer, ZeroLengthHelpersRotateTheirBone) {
  const Clip helped = walk_with_more_joints(), plain = recorded_clip("walk");
  const TransferTarget with = understood(helped), without = understood(plain);
  const auto is_same = [](const HumanClip& a, const HumanClip& b) {
    for (int frame = 0; frame < a.frame_count; frame += 25) {
      for (const char* name : {"LeftLeg", "LeftFoot", "LeftToe", "RightToe"}) {
        const Bone bone = *bone_from_name(name);
        ASSERT_LT((a.frame(frame)[bone].translation - b.frame(frame)[bone].translation).norm(),
                  0.001)
            << name << " " << frame;
      }
    }
  };
  is_same(human_of(transfer(helped, with.calibration, without), without), human_of(helped, with));
  is_same(human_of(transfer(plain, without.calibration, with), with), human_of(plain, without));
}

// On a skeleton rooted at the head, trunk joints rotate other parts than their own; the pelvis
// between Hips and Spine maps to no bone and stays at rest.
TEST(Transfer, HandlesTrunksRootedAtTheHead) {
  const Clip walk = with_t_pose_as_zero(recorded_clip("walk")), hanging = rooted_at_head(walk);
  const TransferTarget source = understood(walk), target = understood(hanging);
  const HumanClip was = human_of(walk, source),
                  is = human_of(transfer(walk, source.calibration, target), target);
  for (int frame = 0; frame < was.frame_count; frame += 25) {
    for (const Bone bone : kMappedBones) {
      ASSERT_LT((is.frame(frame)[bone].translation - was.frame(frame)[bone].translation).norm(),
                0.002)
          << bone_name(bone) << " " << frame;
    }
  }
}

TEST(Transfer, ReportsJointsThatAreNotCopied) {
  const Clip more = walk_with_more_joints(), plain = recorded_clip("walk");
  const TransferTarget with_more = understood(more), without = understood(plain);
  const std::vector<std::string> names{"Bag", "Neck2", "LeftIndex1", "LeftIndex2"};
  const UncarriedJoints dropped = uncarried_joints(more, with_more.calibration, without);
  EXPECT_EQ(dropped.left_out, names);
  EXPECT_TRUE(dropped.at_rest.empty());
  const UncarriedJoints lacking = uncarried_joints(plain, without.calibration, with_more);
  EXPECT_TRUE(lacking.left_out.empty());
  EXPECT_EQ(lacking.at_rest, names);
}

// Skeletons of other software: the transferred motion is recognised as the same human.
TEST(Transfer, HumanIsPreservedThroughEveryDialect) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const Clip walk = recorded_clip("walk");
  const TransferTarget source = understood(walk);
  const HumanClip human = human_of(walk, source);
  const double floor = floor_height(walk, source.calibration).value();
  for (const char* file : {"cmu_motionbuilder_12_01_walk", "games105_walk60", "makehuman_walk1",
                           "xsens_boxing_120fps", "vicon_mixed_orders_zup_inch_1"}) {
    const auto path = *shared / "data" / "dialects" / (std::string(file) + ".bvh");
    const Clip clip = load_bvh(path.string()).value().clip;
    const TransferTarget target = understood(clip);
    const Clip moved = transfer(walk, source.calibration, target);
    const double scale = target.calibration.size / human.size;
    EXPECT_NEAR(floor_height(moved, target.calibration).value(), scale * floor, 0.02) << file;
    EXPECT_EQ(moved.skeleton().names(), clip.skeleton().names());
    const HumanClip again = to_human(moved, target.calibration);
    for (int frame = 0; frame < human.frame_count; frame += 10) {
      for (const Bone bone : kMappedBones) {
        if (target.map.joint_of_bone[bone] < 0) continue;
        const auto& before = human.frame(frame)[bone].rotation;
        const auto& after = again.frame(frame)[bone].rotation;
        ASSERT_GT(std::abs(before.dot(after)), 1.0 - 1e-9) << file << " " << bone_name(bone);
      }
      const Eigen::Vector3d from_scaled = again.frame(frame)[Bone::kHips].translation -
                                          human.frame(frame)[Bone::kHips].translation * scale;
      ASSERT_LT(from_scaled.head<2>().norm(), 1e-9) << file;
      const Eigen::Vector3d first =
          again.frame(0)[Bone::kHips].translation - human.frame(0)[Bone::kHips].translation * scale;
      ASSERT_NEAR(from_scaled.z(), first.z(), 1e-9) << file;
    }
  }
}

}  // namespace
}  // namespace retarget
