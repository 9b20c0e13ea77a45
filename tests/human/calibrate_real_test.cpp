// Calibration of real files, if they are available.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/limb_angles.h"
#include "human/shipped_profiles.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "retarget/human_skeleton.h"
#include "support/angles.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

Clip load(const std::string& folder, const std::string& name) {
  return load_bvh((*shared_folder() / "data" / folder / name).string()).value().clip;
}

// LAFAN1's own axes in frames in which its people stand nearly in a T-pose.
TEST(CalibrateReal, CanonicalTPoseMatchesLafan1) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  struct Frame {
    const char* file;
    int frame;
  };
  BoneArray<double> sums;
  const std::vector<Frame> frames = {{"obstacles1_subject1.bvh", 51},
                                     {"walk4_subject1.bvh", 4917},
                                     {"multipleActions1_subject1.bvh", 4518}};
  for (const auto& [file, number] : frames) {
    const Clip clip = load("lafan1", file);
    const HumanClip human =
        to_human(cut(clip, number, number + 1), lafan1_calibration(clip.skeleton()));
    const HumanPose& pose = human.frame(0);
    const auto at = [&](const char* bone) { return pose[*bone_from_name(bone)].translation; };
    Eigen::Vector3d left = at("LeftUpLeg") - at("RightUpLeg") + at("LeftArm") - at("RightArm");
    left.z() = 0.0;
    const auto body_from_world =
        Eigen::Quaterniond::FromTwoVectors(left.normalized(), Eigen::Vector3d::UnitY());
    for (const Bone bone : kAllBones) {
      const Eigen::Quaterniond axes(canonical_t_pose(bone));
      sums[bone] += (body_from_world * pose[bone].rotation).angularDistance(axes) * kDegrees;
    }
  }
  for (const Bone bone : kAllBones) {
    // People turn their feet out and let their hands hang.
    const bool is_end = bone_name(bone).find("Hand") != std::string_view::npos ||
                        bone_name(bone).find("ForeArm") != std::string_view::npos;
    EXPECT_LT(sums[bone] / 3.0, is_end ? 32.0 : 20.0) << bone_name(bone);
  }
}

TEST(CalibrateReal, Lafan1IsUnchanged) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  for (const char* file : {"dance1_subject2.bvh", "ground1_subject1.bvh"}) {
    const Clip clip = load("lafan1", file);
    const auto found = calibrate(clip, lafan1_map(clip.skeleton(), "lafan1"), {}).value();
    const HumanClip a = to_human(clip, found);
    const HumanClip b = lafan1_human(clip);
    ASSERT_EQ(a.world_from_bone.size(), b.world_from_bone.size());
    EXPECT_EQ(std::memcmp(a.world_from_bone.data(), b.world_from_bone.data(),
                          a.world_from_bone.size() * sizeof(HumanPose)),
              0);
  }
}

// The axes are known: those of LAFAN1's joints, which the method does not use. In parts in which
// people lie, trunk and legs point along the floor.
TEST(CalibrateReal, LyingBodyKeepsTheUpAxisOfItsSkeletonKind) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  const auto profiles =
      load_skeleton_profiles(std::string(RETARGET_SOURCE_DIR) + "/configs/skeletons");
  for (const char* file : {"ground1_subject1.bvh", "fallAndGetUp2_subject2.bvh"}) {
    const Clip clip = load("lafan1", file);
    const BoneMap map = recognise_skeleton(clip, *profiles).value();
    constexpr int kFrames = 200;
    for (int begin = 0; begin + kFrames <= clip.frame_count(); begin += kFrames / 2) {
      const auto found = value_of(calibrate(cut(clip, begin, begin + kFrames), map, {}));
      EXPECT_GT(found.human_from_source(2, 1), 0.99) << file << " from frame " << begin;
    }
  }
}

TEST(CalibrateReal, LearnsLafan1sAxesFromItsMovements) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  double sum = 0.0;
  int count = 0;
  const std::vector<std::pair<const char*, const char*>> clips = {
      {"lafan1", "dance1_subject2.bvh"},          {"lafan1", "fallAndGetUp2_subject2.bvh"},
      {"lafan1", "obstacles1_subject1.bvh"},      {"lafan1", "walk4_subject1.bvh"},
      {"lafan1_cuts", "walk1_subject1_walk.bvh"}, {"lafan1_cuts", "run2_subject4_run.bvh"}};
  for (const auto& [folder, file] : clips) {
    const Clip clip = load(folder, file);
    const auto found = calibrate(clip, lafan1_map(clip.skeleton(), "unknown"), {}).value();
    EXPECT_EQ(found.rest_pose, "learned");
    EXPECT_EQ(found.unit, "cm");
    EXPECT_EQ(found.up, SignedAxis{});
    EXPECT_NEAR(found.height, 1.75, 0.01);
    EXPECT_TRUE(found.doubts.empty()) << file;
    // Bones with a weight in the published tables.
    for (const char* bone :
         {"Hips", "Spine2", "LeftUpLeg", "LeftLeg", "LeftFootMod", "RightUpLeg", "RightLeg",
          "RightFootMod", "LeftArm", "LeftForeArm", "RightArm", "RightForeArm"}) {
      const double degrees =
          Eigen::AngleAxisd(*found.bones[*bone_from_name(bone)].joint_from_bone).angle() * kDegrees;
      const double turn = std::min(degrees, 360.0 - degrees);
      EXPECT_LT(turn, 15.0) << file << " " << bone;
      sum += turn;
      ++count;
    }
  }
  EXPECT_LT(sum / count, 5.0);
}

TEST(CalibrateReal, LimbsOfEveryDialectMatchTheirBoneAxes) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  for (const ProfileFile& profile : profile_files()) {
    SCOPED_TRACE(profile.file);
    const Clip clip = load("dialects", profile.file);
    const auto found = value_of(calibrate(clip, bone_map(clip.skeleton(), profile.names), {}));
    EXPECT_EQ(found.unit, profile.unit);
    // One body has a child's height, which causes a warning.
    EXPECT_EQ(found.doubts.empty(), found.height > 1.3);
    EXPECT_GT(found.height, 1.1);
    EXPECT_LT(found.height, 1.9);
    const HumanClip human = to_human(clip, found);
    double sum = 0.0;
    const auto angles = limb_angles(human);
    for (const LimbAngle& angle : angles) {
      EXPECT_LT(angle.mean, 10.0) << angle.limb;
      sum += angle.mean;
    }
    EXPECT_LT(sum / static_cast<double>(angles.size()), 2.0);
    // No lying or sunken body: hips at human height above the lower foot.
    for (int frame = 0; frame < human.frame_count; frame += 10) {
      const auto pose = human.frame(frame);
      const double foot =
          std::min(pose[Bone::kLeftFoot].translation.z(), pose[Bone::kRightFoot].translation.z());
      const double hips = pose[Bone::kHips].translation.z() - foot;
      EXPECT_GT(hips, 0.2 * human.height) << frame;
      EXPECT_LT(hips, 1.2) << frame;
    }
  }
}

}  // namespace
}  // namespace retarget
