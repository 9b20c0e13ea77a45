// Files exported by Blender from the repository's samples (make_exported_files.py): the same
// motion, joint by joint.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "formats/bvh/read_bvh.h"
#include "formats/scene/read_scene.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"
#include "support/world_poses.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

const std::string kFolder = std::string(RETARGET_SOURCE_DIR) + "/tests/scene/data/";

Clip exported_clip(const std::string& name, const std::string& take = {}) {
  SceneReadOptions options;
  options.take = take;
  return value_of(read_scene(value_of(read_file(kFolder + name)).view(), name, options));
}

// The largest distance of a joint from the sample's in metres, Y up.
double distance(const Clip& found, const std::string& sample, int first) {
  const Clip clip = recorded_clip(sample);
  const double unit = *found.origin().metres_per_unit;
  const Eigen::Vector3d up = *found.origin().up;
  Eigen::Matrix3d y_up = Eigen::Matrix3d::Identity();
  if (up == Eigen::Vector3d::UnitZ()) y_up << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  double largest = 0.0;
  for (int frame = 0; frame < found.frame_count(); ++frame) {
    const auto expected = world_poses(clip, first + frame);
    const auto poses = world_poses(found, frame);
    for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
      const auto same = found.skeleton().find(clip.skeleton().joint(joint).name);
      EXPECT_TRUE(same.has_value()) << clip.skeleton().joint(joint).name;
      if (!same) return HUGE_VAL;
      const Eigen::Vector3d place = unit * (y_up * poses[*same].translation);
      largest = std::max(largest, (place - 0.01 * expected[joint].translation).norm());
    }
  }
  return largest;
}

constexpr double kMillimetre = 1e-3;
constexpr int kFrames = 11;

TEST(ExportedFilesTest, ContainTheMotionOfTheSample) {
  for (const char* name : {"walk.fbx", "walk.glb"}) {
    const Clip clip = exported_clip(name);
    EXPECT_EQ(clip.frame_count(), kFrames) << name;
    EXPECT_EQ(to_text(clip.rate()), "30") << name;
    EXPECT_LT(distance(clip, "walk", 60), 0.01 * kMillimetre) << name;
  }
}

// An export with Z up, leaf bones and a skin.
TEST(ExportedFilesTest, MayHaveOtherAxesAndUnits) {
  const Clip clip = exported_clip("wave_z_up.fbx");
  EXPECT_EQ(*clip.origin().up, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(clip.skeleton().find("Head_end").has_value());
  EXPECT_LT(distance(clip, "wave", 30), 0.01 * kMillimetre);
}

TEST(ExportedFilesTest, MayContainSeveralTakes) {
  const Clip wave = exported_clip("takes.glb", "Wave");
  EXPECT_LT(distance(wave, "wave", 30), 0.01 * kMillimetre);
  EXPECT_EQ(wave.origin().takes.size(), 2U);
  // In metres.
  const Clip fbx = exported_clip("takes.fbx", "wave|Wave");
  EXPECT_EQ(*fbx.origin().metres_per_unit, 1.0);
  EXPECT_LT(distance(fbx, "wave", 30), 0.01 * kMillimetre);
  EXPECT_LT(distance(exported_clip("takes.fbx", "wave|Squat"), "squat", 40), 0.01 * kMillimetre);
  EXPECT_LT(distance(exported_clip("takes.glb", "Squat"), "squat", 40), 0.01 * kMillimetre);
}

// The bind pose of the skin: without rotations, joints have the positions of the sample's zero
// pose.
TEST(ExportedFilesTest, HaveTheBindPoseAsZeroPose) {
  for (const char* name : {"walk.glb", "wave_z_up.fbx"}) {
    const Clip clip = exported_clip(name);
    const auto leg = clip.skeleton().find("LeftLeg");
    ASSERT_TRUE(leg) << name;
    // Along x, as in the sample.
    const Eigen::Vector3d offset =
        *clip.origin().metres_per_unit * clip.skeleton().joint(*leg).offset;
    EXPECT_LT((offset - Eigen::Vector3d(0.426, 0, 0)).norm(), kMillimetre) << name;
  }
}

// If any byte changes, the file is rejected with a message, or read with finite numbers.
TEST(ExportedFilesTest, DoNotCrashTheReaderIfDamaged) {
  for (const char* name : {"walk.fbx", "walk.glb"}) {
    const std::string good(value_of(read_file(kFolder + name)).view());
    SceneReadOptions options;
    options.max_clip_bytes = std::size_t{1} << 20U;
    unsigned state = 1;
    const auto random = [&state](std::size_t below) {
      state = state * 1664525U + 1013904223U;
      return static_cast<std::size_t>(state >> 8U) % below;
    };
    for (int round = 0; round < 60; ++round) {
      std::string bad = good;
      if (round % 3 == 0) {
        bad.resize(random(good.size()));
      } else {
        for (int change = 0; change < 4; ++change) {
          bad[random(round % 3 == 1 ? 4000 : good.size())] = static_cast<char>(random(256));
        }
      }
      const auto clip = read_scene(bad, "damaged", options);
      if (!clip) {
        EXPECT_FALSE(clip.error().message.empty());
        continue;
      }
      for (int frame = 0; frame < clip->frame_count(); ++frame) {
        for (const auto& rotation : clip->rotations(frame)) EXPECT_NEAR(rotation.norm(), 1.0, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace retarget
