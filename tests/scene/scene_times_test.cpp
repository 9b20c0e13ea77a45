// The frames that are sampled from the keys of a scene.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "fbx_text.h"
#include "formats/scene/read_scene.h"
#include "gltf_text.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

// A node whose x is the number of its key, at these times.
Animated counting(const std::vector<double>& times) {
  Animated moved;
  for (std::size_t i = 0; i < times.size(); ++i) {
    moved.times.push_back(static_cast<float>(times[i]));
    moved.values.insert(moved.values.end(), {static_cast<float>(i), 0, 0});
  }
  return moved;
}

std::vector<double> even_times(int count, double step, double begin = 0.0) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(begin + i * step);
  return times;
}

// All warnings of a clip, one per line; the message of an error.
std::string warnings_of(const Result<Clip>& clip) {
  if (!clip) return clip.error().message;
  std::string text;
  for (const Warning& warning : clip->origin().warnings) text += warning.message + "\n";
  return text;
}

void expect_all_keys(const std::vector<double>& times, const std::string& rate) {
  const auto clip = read_scene(counting(times).text(), "test.gltf");
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_EQ(to_text(clip->rate()), rate);
  EXPECT_EQ(warnings_of(clip), "");
  ASSERT_EQ(clip->frame_count(), static_cast<int>(times.size()));
  for (int frame = 0; frame < clip->frame_count(); ++frame) {
    ASSERT_EQ(clip->translation(frame, 0).x(), frame);
  }
}

TEST(SceneTimesTest, ReadsAllKeysOfLongAndLateClips) {
  expect_all_keys(even_times(12000, 1.0 / 60), "60");
  expect_all_keys(even_times(12000, 1.0 / 120), "120");
  expect_all_keys(even_times(6000, 1.0 / 30), "30");
  expect_all_keys(even_times(300, 1.0 / 60, 600.0), "60");
  // The frame time that many BVH files state for 30 fps.
  expect_all_keys(even_times(3000, 0.033333), "30");
}

TEST(SceneTimesTest, ReadsAllKeysAtTheirOwnRateByRequest) {
  SceneReadOptions options;
  options.source_fps = 30.0;
  const auto clip =
      value_of(read_scene(counting(even_times(301, 0.033333)).text(), "test.gltf", options));
  EXPECT_EQ(clip.frame_count(), 301);
}

TEST(SceneTimesTest, RejectsKeysThatAreTooDense) {
  for (const double step : {1.0 / 2000.0, 1e-6 / 30.0}) {
    const auto clip = read_scene(counting(even_times(301, step)).text(), "test.gltf");
    ASSERT_FALSE(clip);
    EXPECT_THAT(clip.error().message, HasSubstr("its 301 key times lie within"));
    EXPECT_THAT(clip.error().hint, HasSubstr(OPTION("source-fps")));
  }
  expect_all_keys(even_times(301, 1.0 / 1000.0), "1000");
}

TEST(SceneTimesTest, WarnsWhenADefaultRateInventsOrDiscardsFrames) {
  EXPECT_THAT(warnings_of(read_scene(counting(even_times(101, 0.1)).text(), "test.gltf")),
              HasSubstr("its keys are at 10 fps, below 12: 101 key times became 301 frames at 30 "
                        "fps"));
  std::vector<double> uneven = even_times(101, 0.01);
  for (std::size_t i = 1; i < 100; i += 2) uneven[i] += 0.004;
  EXPECT_THAT(warnings_of(read_scene(counting(uneven).text(), "test.gltf")),
              HasSubstr("its keys are not evenly spaced: 101 key times became 31 frames"));
  EXPECT_THAT(warnings_of(read_scene(counting({0, 1}).text(), "test.gltf")),
              HasSubstr("too few keys to determine a rate: 2 key times became 31 frames"));
  // A pose is one frame.
  EXPECT_THAT(warnings_of(read_scene(counting({0}).text(), "test.gltf")),
              ::testing::Not(HasSubstr("became")));
}

// A limb that moves along x; x is the number of the key.
std::string fbx_of_keys(const std::vector<double>& times, int time_mode, double begin, double end) {
  FbxText file({1, 1, 1.0, time_mode});
  const int root = file.node("Hips", 0, {0, 0, 0});
  file.take("move", begin, end);
  std::vector<std::pair<double, FbxText::Vector>> keys;
  for (std::size_t i = 0; i < times.size(); ++i) {
    keys.emplace_back(times[i], FbxText::Vector{static_cast<double>(i), 0, 0});
  }
  file.keys(root, "Lcl Translation", keys);
  return file.text();
}

TEST(SceneTimesTest, ReadsAllFbxKeysThatAreRoundedToMilliseconds) {
  std::vector<double> times;
  for (int i = 0; i <= 300; ++i) times.push_back(1e-3 * std::round(1e3 * i / 60.0));
  // The file states 24 fps.
  const auto clip = read_scene(fbx_of_keys(times, 11, 0, times.back()), "test.fbx");
  ASSERT_TRUE(clip) << clip.error().message;
  EXPECT_EQ(to_text(clip->rate()), "60");
  EXPECT_EQ(warnings_of(clip), "");
  ASSERT_EQ(clip->frame_count(), 301);
  for (int frame = 0; frame <= 300; ++frame) {
    ASSERT_NEAR(clip->translation(frame, 0).x(), frame, 1e-6);
  }
}

TEST(SceneTimesTest, WarnsAboutFbxKeysBetweenFrames) {
  std::vector<double> uneven = even_times(101, 0.01);
  for (std::size_t i = 1; i < 100; i += 2) uneven[i] += 0.004;
  const auto clip = read_scene(fbx_of_keys(uneven, 6, 0, 1), "test.fbx");
  EXPECT_THAT(warnings_of(clip), HasSubstr("101 key times became 31 frames at 30 fps"));
  // Keys of curves are sparse.
  EXPECT_EQ(warnings_of(read_scene(fbx_of_keys({0, 0.37, 0.5, 1}, 6, 0, 1), "test.fbx")), "");
}

TEST(SceneTimesTest, WarnsAboutFbxKeysOutsideOfTheTake) {
  const std::vector<double> times = even_times(301, 1.0 / 30);
  const auto part = read_scene(fbx_of_keys(times, 6, 1, 4), "test.fbx");
  ASSERT_TRUE(part);
  EXPECT_EQ(part->frame_count(), 91);
  EXPECT_EQ(part->translation(0, 0).x(), 30.0);
  EXPECT_THAT(warnings_of(part), HasSubstr("the take lasts from 1 s to 4 s, as the file states, "
                                           "but its keys from 0 s to 10 s: 7 s of keys"));
  EXPECT_EQ(warnings_of(read_scene(fbx_of_keys(times, 6, 0, 10), "test.fbx")), "");
  EXPECT_EQ(warnings_of(read_scene(fbx_of_keys(times, 6, -5, 20), "test.fbx")), "");
  // The last frame is missing.
  EXPECT_THAT(warnings_of(read_scene(fbx_of_keys(times, 6, 0, 299.0 / 30), "test.fbx")),
              HasSubstr("s of keys are not read"));
}

}  // namespace
}  // namespace retarget
