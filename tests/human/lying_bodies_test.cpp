// The up axis of people who lie, crawl, swim or stand on their hands for a whole clip.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/option_name.h"
#include "formats/bvh/read_bvh.h"
#include "formats/smpl/smpl_body.h"
#include "human/doubts.h"
#include "human/posture_targets.h"
#include "human/postures.h"
#include "human/skeleton/recognise.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

const std::string& source_folder() {
  static const std::string folder = RETARGET_SOURCE_DIR;
  return folder;
}

const std::vector<SkeletonProfile>& profiles() {
  static const auto all = load_skeleton_profiles(source_folder() + "/configs/skeletons").value();
  return all;
}

const Clip& walk() {
  static const Clip clip = recorded_clip("walk");
  return clip;
}

enum class Demand : unsigned char { kRight, kRightOrWarned };

// The axis is correct, or there is a warning; for upright bodies it is correct without a warning.
void expect_up(const PostureTarget& target, Posture posture, double heading, Demand demand) {
  SCOPED_TRACE(target.name + ", " + posture_name(posture) + ", " + std::to_string(heading));
  static const PostureClips postures(walk());
  Clip clip = transfer(postures.make(posture, heading, 60), postures.calibration(), target.target);
  clip.set_origin(target.origin);
  const auto map = value_of(recognise_skeleton(clip, profiles()));
  const auto found = value_of(calibrate(clip, map, {}));
  const bool is_right = found.up == target.target.calibration.up;
  EXPECT_TRUE(is_right || (demand == Demand::kRightOrWarned && has_doubt(found, OPTION("up"))))
      << to_text(found.up);
}

void expect_up_in_all_postures(const PostureTarget& target, Demand demand) {
  for (const Posture posture : kPostures) {
    for (const double heading : {0.0, 90.0, 180.0, 270.0, 30.0}) {
      expect_up(target, posture, heading, is_upright(posture) ? Demand::kRight : demand);
    }
  }
}

PostureTarget smpl_target() {
  const auto skeleton = smpl_skeleton(generic_smpl_rest_body(1.7));
  Clip clip(skeleton, FrameRate{}, 1);
  clip.rotations(0)[0] = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
  clip.translations(0)[0] = {0.0, 0.0, 0.95};
  ClipOrigin origin;
  origin.name = "AMASS";
  origin.up = Eigen::Vector3d::UnitZ();
  clip.set_origin(origin);
  BoneMap map = recognise_skeleton(clip, profiles()).value();
  Calibration calibration = calibrate(clip, map, {}).value();
  return {"AMASS", {skeleton, std::move(map), std::move(calibration)}, origin};
}

// The kind determines the axis if its profile names one, otherwise the zero pose does.
TEST(LyingBodies, KeepTheUpAxisOfEveryKindOfSkeleton) {
  for (const SkeletonProfile& profile : profiles()) {
    if (profile.name == "slimevr") continue;  // Its root is the head.
    const SignedAxis up = nearest_axis(profile.facts.up.value_or(Eigen::Vector3d::UnitY()));
    expect_up_in_all_postures(posture_target(profile, walk(), up), Demand::kRight);
  }
}

// Files rotated away from the axis of their kind.
TEST(LyingBodies, AreCorrectOrWarnedAboutInRotatedFiles) {
  for (const char* name : {"mixamo", "lafan1", "cmu_daz", "vicon", "smpl", "biped"}) {
    const auto profile = std::ranges::find(profiles(), name, &SkeletonProfile::name);
    ASSERT_NE(profile, profiles().end());
    const bool is_z = profile->facts.up && profile->facts.up->z() > 0.5;
    expect_up_in_all_postures(posture_target(*profile, walk(), SignedAxis{is_z ? 1 : 2, false}),
                              Demand::kRightOrWarned);
  }
}

TEST(LyingBodies, KeepTheUpAxisThatTheFileStates) {
  expect_up_in_all_postures(smpl_target(), Demand::kRight);
  for (const char* file : {"walk.glb", "walk.fbx", "wave_z_up.fbx"}) {
    const auto target = posture_target(fs::path(source_folder()) / "tests/scene/data" / file);
    ASSERT_TRUE(target) << file;
    for (const Posture posture : kPostures) {
      // The zero poses of these FBX files are not T-poses, and bodies on one side show no facing.
      if (posture == Posture::kOnSide && std::string(file).ends_with("fbx")) continue;
      for (const double heading : {0.0, 90.0, 180.0, 270.0}) {
        expect_up(*target, posture, heading, Demand::kRight);
      }
    }
  }
}

TEST(LyingBodies, AreCorrectInEveryFileFormat) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  int count = 0;
  for (const char* folder : {"dialects", "smpl", "formats"}) {
    for (const auto& entry : fs::directory_iterator(*shared_folder() / "data" / folder)) {
      const auto target = posture_target(entry.path());
      if (!target) continue;
      ++count;
      for (const Posture posture : kPostures) {
        if (posture == Posture::kOnSide) continue;
        for (const double heading : {0.0, 90.0, 180.0, 270.0}) {
          expect_up(*target, posture, heading,
                    is_upright(posture) ? Demand::kRight : Demand::kRightOrWarned);
        }
      }
    }
  }
  EXPECT_GE(count, 15);
}

Clip excerpt(const Clip& clip, int begin, int count) {
  Clip part(clip.shared_skeleton(), clip.rate(), count);
  for (int frame = 0; frame < count; ++frame) {
    std::ranges::copy(clip.rotations(begin + frame), part.rotations(frame).begin());
    std::ranges::copy(clip.translations(begin + frame), part.translations(frame).begin());
  }
  return part;
}

// Recorded people who lie or crawl for five seconds, in files with Y up and turned to Z up.
TEST(LyingBodies, AreCorrectOrWarnedAboutInRecordedExcerpts) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  constexpr int kFrames = 150, kStep = 75;
  constexpr double kLyingHips = 55.0;  // cm
  const Eigen::Quaterniond z_up(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  int windows = 0, turned_back = 0;
  for (const char* name : {"ground1_subject1.bvh", "fallAndGetUp2_subject2.bvh"}) {
    const Clip clip = load_bvh(*shared_folder() / "data/lafan1" / name).value().clip;
    const BoneMap map = recognise_skeleton(clip, profiles()).value();
    for (int begin = 0; begin + kFrames <= clip.frame_count(); begin += kStep) {
      const Clip part = excerpt(clip, begin, kFrames);
      if (part.translations(kFrames / 2)[0].y() > kLyingHips) continue;
      SCOPED_TRACE(std::string(name) + " " + std::to_string(begin));
      ++windows;
      const auto plain = calibrate(part, map, {});
      const auto turned = calibrate(scaled_and_turned(part, 1.0, z_up), map, {});
      ASSERT_TRUE(plain && turned);
      EXPECT_EQ(to_text(plain->up), "+y");
      const bool is_right = to_text(turned->up) == "+z";
      EXPECT_TRUE(is_right || has_doubt(*turned, OPTION("up"))) << to_text(turned->up);
      turned_back += is_right ? 1 : 0;
    }
  }
  EXPECT_GE(windows, 80);
  EXPECT_GE(turned_back, 6 * windows / 10);
}

}  // namespace
}  // namespace retarget
