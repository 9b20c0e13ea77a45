
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "edit/body_mirror.h"
#include "edit/ground_pose.h"
#include "edit_sample.h"
#include "retarget/edit.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using namespace edit_test;

// Mirrors by name; mirrored() is the library's function.
Bone mate_of_bone(Bone bone) {
  const std::string name(bone_name(bone));
  if (name.starts_with("Left")) return *bone_from_name("Right" + name.substr(4));
  if (name.starts_with("Right")) return *bone_from_name("Left" + name.substr(5));
  return bone;
}

TEST(Mirror, TwiceIsIdentity) {
  for (const char* name : {"walk", "get_up", "turn_in_place"}) {
    const EditSample& sample = data_sample(name);
    const Clip once = mirror(sample.clip, sample.calibration).value();
    const Clip twice = mirror(once, sample.calibration).value();
    EXPECT_LT(largest_distance(twice, sample.clip, 0.01), 1e-8) << name;
    for (int frame = 0; frame < twice.frame_count(); ++frame) {
      for (int joint = 0; joint < twice.skeleton().joint_count(); ++joint) {
        const auto& a = twice.rotations(frame)[joint];
        const auto& b = sample.clip.rotations(frame)[joint];
        ASSERT_LT(std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm()),
                  1e-9);
      }
    }
  }
}

// The synthetic body is symmetric: every bone is at the mirror image of its counterpart.
TEST(Mirror, BonesAreMirrorImages) {
  const EditSample& sample = data_sample("wave");
  const Clip image = mirror(sample.clip, sample.calibration).value();
  const HumanClip before = sample.human(), after = sample.human_of(image);
  const GroundPose start = hips_over_ground(before).front();
  for (int frame = 0; frame < before.frame_count; frame += 7) {
    for (const Bone bone : kMappedBones) {
      if (!before.has(bone)) continue;
      const auto seen = [&](const HumanClip& human, Bone which) {
        return Eigen::Vector3d(start.inverse().in_space() * human.frame(frame)[which].translation);
      };
      Eigen::Vector3d wanted = seen(before, mate_of_bone(bone));
      wanted.y() = -wanted.y();
      ASSERT_LT((seen(after, bone) - wanted).norm(), 1e-9) << bone_name(bone);
    }
  }
}

// A calibration with random errors of its axes, as after learning them from the movement.
TEST(Mirror, MirrorsErrorsOfTheCalibration) {
  for (const char* name : {"walk", "get_up"}) {
    const EditSample& sample = data_sample(name);
    Calibration calibration = sample.calibration;
    for (const Bone bone : kMappedBones) {
      const auto i = static_cast<double>(bone);
      const Eigen::Vector3d error(std::sin(3.0 * i), std::sin(5.0 * i), std::sin(7.0 * i));
      BoneSource& source = calibration.bones[bone];
      source.joint_from_bone =
          source.joint_from_bone.value_or(Eigen::Quaterniond::Identity()) * exp_so3(0.2 * error);
    }
    const MirroredHuman image =
        mirror_human(sample.clip, calibration, mirror_plane(sample.clip, calibration)).value();
    const HumanClip before = to_human(sample.clip, calibration);
    const HumanClip after = to_human(image.clip, image.calibration);
    const Pose start = hips_over_ground(before).front().in_space();
    const Eigen::DiagonalMatrix<double, 3> across(1.0, -1.0, 1.0);
    for (int frame = 0; frame < before.frame_count; frame += 7) {
      for (const Bone bone : kMappedBones) {
        if (!before.has(bone)) continue;
        const Bone mate = mate_of_bone(bone);
        const auto turn = [&](const HumanClip& human, Bone which) -> Eigen::Matrix3d {
          return (start.rotation.conjugate() * human.frame(frame)[which].rotation)
                     .toRotationMatrix() *
                 canonical_t_pose(which).transpose();
        };
        const Eigen::Matrix3d wanted = across * turn(before, bone) * across;
        ASSERT_LT((turn(after, mate) - wanted).norm(), 1e-9) << bone_name(bone);
      }
    }
    // The calibration of a symmetric body is unchanged, to the bit.
    const MirroredHuman exact =
        mirror_human(sample.clip, sample.calibration, mirror_plane(sample.clip, sample.calibration))
            .value();
    for (const Bone bone : kMappedBones) {
      EXPECT_EQ(exact.calibration.bones[bone].joint_from_bone.has_value(),
                sample.calibration.bones[bone].joint_from_bone.has_value());
    }
  }
}

TEST(Mirror, IgnoresNames) {
  const EditSample& sample = data_sample("walk");
  std::vector<Joint> joints = sample.clip.skeleton().joints();
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i].name = "j" + std::to_string(i);
  const Skeleton nameless(joints);
  EXPECT_EQ(body_mirror(nameless, sample.calibration).value().mates,
            body_mirror(sample.clip.skeleton(), sample.calibration).value().mates);
}

TEST(Mirror, PairsOtherJointsByShape) {
  const EditSample& sample = data_sample("walk");
  std::vector<Joint> joints = sample.clip.skeleton().joints();
  const auto add = [&joints](int parent, const char* name, const Eigen::Vector3d& offset) {
    Joint joint = joints[parent];
    joint.parent = parent;
    joint.name = name;
    joint.offset = offset;
    joints.push_back(joint);
    return static_cast<int>(joints.size()) - 1;
  };
  // Two fingers on each hand, in another order; in LAFAN1's axes their positions mirror about x, y.
  const int left = sample.map.joint(Bone::kLeftHand), right = sample.map.joint(Bone::kRightHand);
  const int thumb = add(left, "a", {3.0, 2.0, 1.0}), ring = add(left, "b", {9.0, 0.0, -2.0});
  const int other_ring = add(right, "c", {9.0, 0.0, 2.0});
  const int other_thumb = add(right, "d", {3.0, 2.0, -1.0});
  const auto mates = body_mirror(Skeleton(joints), sample.calibration).value().mates;
  EXPECT_EQ(mates[thumb], other_thumb);
  EXPECT_EQ(mates[other_ring], ring);
  // An additional finger on one hand has no counterpart.
  add(right, "sixth", {4.0, -2.0, 0.0});
  const auto lonely = body_mirror(Skeleton(joints), sample.calibration);
  ASSERT_FALSE(lonely);
  EXPECT_EQ(lonely.error().kind, ErrorKind::kInput);
  EXPECT_THAT(lonely.error().message, testing::HasSubstr("counterpart"));
}

// Real skeletons of other software, with fingers and helper joints.
TEST(Mirror, TwiceIsIdentityForEveryDialect) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  for (const char* file : {"cmu_motionbuilder_12_01_walk", "games105_walk60", "makehuman_walk1",
                           "xsens_boxing_120fps", "vicon_mixed_orders_zup_inch_1"}) {
    const auto path = *shared / "data" / "dialects" / (std::string(file) + ".bvh");
    const Clip clip = load_bvh(path.string()).value().clip;
    const EditSample sample(cut(clip, 0, std::min(clip.frame_count(), 200)));
    const auto once = value_of(mirror(sample.clip, sample.calibration));
    const Clip twice = mirror(once, sample.calibration).value();
    EXPECT_LT(largest_distance(twice, sample.clip, sample.calibration.metres_per_unit), 1e-7)
        << file;
    EXPECT_LT(largest_distance(through_bvh(once), once, sample.calibration.metres_per_unit), 1e-7);
    // The mirrored body is an upright walking human with its left on the left.
    const EditSample again(once);
    EXPECT_EQ(again.map.joint_of_bone, sample.map.joint_of_bone) << file;
  }
}

// The guess of the T-pose does not affect the mirror image: the written file mirrors back.
TEST(Mirror, TwiceIsIdentityThroughFiles) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int tried = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "data" / "dialects")) {
    if (entry.path().extension() != ".bvh") continue;
    const auto read = load_bvh(entry.path().string());
    if (!read || !recognise_skeleton(read->clip, all_profiles())) continue;
    // A part in which the T-pose must be guessed.
    const int frames = read->clip.frame_count();
    const EditSample sample(cut(read->clip, std::min(10, frames - 1), std::min(frames, 100)));
    const std::string file = entry.path().filename().string();
    const auto once = mirror(sample.clip, sample.calibration);
    if (!once) continue;
    ++tried;
    const EditSample again(through_bvh(*once));
    const auto twice = value_of(mirror(again.clip, again.calibration));
    EXPECT_LT(largest_distance(twice, sample.clip, sample.calibration.metres_per_unit), 1e-4)
        << file;
  }
  EXPECT_GT(tried, 10);
}

}  // namespace
}  // namespace retarget
