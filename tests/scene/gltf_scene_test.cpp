#include "formats/scene/read_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/stat.h>
#endif

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "gltf_text.h"
#include "retarget/bytes.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr std::size_t kGltfMemory = std::size_t{1} << 30U;

SceneGraph gltf_scene(const std::string& text) {
  return value_of(read_gltf(text, "test.gltf", kGltfMemory));
}

std::string message_of(const std::string& text, const std::string& name = "test.gltf") {
  const auto clip = read_scene(text, name);
  return clip ? "" : clip.error().message;
}

TEST(GltfSceneTest, UsesTheInterpolationOfTheSampler) {
  Animated moved;
  moved.times = {1, 2};
  moved.values = {0, 0, 0, 8, 0, 4};
  const SceneGraph linear = gltf_scene(moved.text());
  EXPECT_EQ(linear.motion->at(0, 0, 1.25).translation, Vector3d(2, 0, 1));
  EXPECT_EQ(linear.motion->at(0, 0, 0.0).translation, Vector3d(0, 0, 0));
  EXPECT_EQ(linear.motion->at(0, 0, 9.0).translation, Vector3d(8, 0, 4));
  EXPECT_EQ(linear.takes[0].begin, 1.0);
  EXPECT_EQ(linear.takes[0].end, 2.0);

  moved.interpolation = "STEP";
  EXPECT_EQ(gltf_scene(moved.text()).motion->at(0, 0, 1.99).translation, Vector3d(0, 0, 0));

  // glTF 2.0, appendix C.5: in-tangent, value, out-tangent; keys two seconds apart.
  moved.interpolation = "CUBICSPLINE";
  moved.times = {0, 2};
  moved.values = {9, 9, 9, 1, 0, 0, 3, 0, 0, -1, 0, 0, 5, 0, 0, 9, 9, 9};
  const double t = 0.25;
  const double expected = (2 * t * t * t - 3 * t * t + 1) * 1 +
                          2 * (t * t * t - 2 * t * t + t) * 3 + (3 * t * t - 2 * t * t * t) * 5 +
                          2 * (t * t * t - t * t) * -1;
  EXPECT_NEAR(gltf_scene(moved.text()).motion->at(0, 0, 0.5).translation.x(), expected, 1e-12);
}

// A float does not equal the frame time exactly, but the jump is still at the frame.
TEST(GltfSceneTest, JumpsAtTheFrameOfItsKey) {
  Animated moved;
  moved.interpolation = "STEP";
  for (int frame = 0; frame < 100; ++frame) {
    moved.times.push_back(static_cast<float>(20.0 + frame / 30.0));
    moved.values.insert(moved.values.end(), {static_cast<float>(frame), 0, 0});
  }
  const auto clip = value_of(read_scene(moved.text(), "test.gltf"));
  ASSERT_EQ(clip.frame_count(), 100);
  for (int frame = 0; frame < 100; ++frame) EXPECT_EQ(clip.translation(frame, 0).x(), frame);
}

TEST(GltfSceneTest, InterpolatesRotationsAlongTheShorterArc) {
  Animated turned;
  turned.path = "rotation";
  turned.type = "VEC4";
  turned.times = {0, 1};
  const auto half = static_cast<float>(std::sqrt(0.5));
  turned.values = {0, 0, 0, 1, 0, -half, 0, -half};  // A quarter turn about y; opposite sign.
  const Eigen::Quaterniond found = gltf_scene(turned.text()).motion->at(0, 0, 0.5).rotation;
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitY()));
  EXPECT_LT(found.angularDistance(expected), 1e-6);
}

TEST(GltfSceneTest, ReplacesSparseElementsAndScalesWholeNumbers) {
  const std::string bytes = packed<float>({0, 1, 2}) +
                            packed<std::int16_t>({0, 0, 0, 32767, 0, 0}) +
                            packed<std::uint16_t>({1, 0}) + packed<float>({7, 8, 9});
  const std::string text = fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "nodes": [{{"name": "Hips"}}], "buffers": [{{"byteLength": {}, "uri":
"data:;base64,{}"}}], "bufferViews": [{{"buffer": 0, "byteLength": 12}},
{{"buffer": 0, "byteOffset": 12, "byteLength": 12}}, {{"buffer": 0, "byteOffset": 24, "byteLength": 2}},
{{"buffer": 0, "byteOffset": 28, "byteLength": 12}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR"}},
{{"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{"count": 1,
"indices": {{"bufferView": 2, "componentType": 5123}}, "values": {{"bufferView": 3}}}}}},
{{"bufferView": 0, "componentType": 5126, "count": 1, "type": "SCALAR"}},
{{"bufferView": 1, "componentType": 5122, "normalized": true, "count": 1, "type": "VEC4"}}],
"animations": [{{"channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}},
{{"sampler": 1, "target": {{"node": 0, "path": "rotation"}}}}],
"samplers": [{{"input": 0, "output": 1}}, {{"input": 2, "output": 3}}]}}]}})",
      bytes.size(), base64_text(bytes));
  const SceneGraph scene = gltf_scene(text);
  EXPECT_EQ(scene.motion->at(0, 0, 0.0).translation, Vector3d::Zero());
  EXPECT_EQ(scene.motion->at(0, 0, 1.0).translation, Vector3d(7, 8, 9));
  EXPECT_EQ(scene.motion->at(0, 0, 0.0).rotation.w(), 1.0);
}

TEST(GltfSceneTest, NamesBonesAsVrmDoes) {
  Animated moved;
  moved.times = {0, 1};
  moved.values = {0, 0, 0, 1, 1, 1};
  moved.nodes =
      R"({"name": "J_Hip", "children": [1]}, {"name": "Torso", "children": [2]}, {"name": "spine"})";
  const char* newer =
      R"(, "extensions": {"VRMC_vrm": {"humanoid": {"humanBones": {"hips": {"node": 0}, "spine": {"node": 1}}}}})";
  const char* older =
      R"(, "extensions": {"VRM": {"humanoid": {"humanBones": [{"bone": "hips", "node": 0}, {"bone": "spine", "node": 1}]}}})";
  for (const char* extension : {newer, older}) {
    moved.more = extension;
    const SceneGraph scene = gltf_scene(moved.text());
    EXPECT_EQ(scene.format, "VRM");
    EXPECT_EQ(scene.nodes[0].name, "hips");
    EXPECT_EQ(scene.nodes[1].name, "spine");
    EXPECT_EQ(scene.nodes[2].name, "spine_node");
    EXPECT_TRUE(scene.nodes[0].is_bone);
  }
}

#ifndef _WIN32  // creates a link
TEST(GltfSceneTest, OpensNoFileOutsideOfItsFolder) {
  Animated moved;
  moved.times = {0, 1};
  moved.values = {0, 0, 0, 1, 1, 1};
  const TemporaryFolder folder;
  const std::string outside = folder.write("outside.bin", moved.bytes());
  std::filesystem::create_directory(folder.path() / "scene");
  folder.write("scene/my buffer.bin", moved.bytes());
  std::filesystem::create_symlink(outside, folder.path() / "scene" / "link.bin");
  const std::string name = (folder.path() / "scene" / "test.gltf").string();
  moved.uri = "my%20buffer.bin";
  EXPECT_EQ(message_of(moved.text(), name), "");
  EXPECT_THAT(message_of(moved.text(), "standard input"),
              HasSubstr("standard input cannot provide"));
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("link.bin"), outside, "file://" + outside,
        std::string("http://example.com/a.bin"), std::string("%2e%2e/outside.bin")}) {
    moved.uri = uri;
    EXPECT_THAT(message_of(moved.text(), name), HasSubstr("not in the folder of the file")) << uri;
  }
}
#endif

TEST(GltfSceneTest, RejectsImpossibleValues) {
  Animated good;
  good.times = {0, 1};
  good.values = {0, 0, 0, 1, 1, 1};
  ASSERT_EQ(message_of(good.text()), "");
  const auto with = [&](auto change) {
    Animated bad = good;
    change(bad);
    return message_of(bad.text());
  };
  EXPECT_THAT(with([](Animated& a) { a.times[1] = NAN; }), HasSubstr("not finite"));
  EXPECT_THAT(with([](Animated& a) { a.values[1] = INFINITY; }), HasSubstr("not finite"));
  EXPECT_THAT(with([](Animated& a) { a.times = {1, 0}; }), HasSubstr("do not ascend"));
  EXPECT_THAT(with([](Animated& a) {
                a.times = {0, 1, 2};
              }),
              HasSubstr("different numbers of times"));
  EXPECT_THAT(with([](Animated& a) { a.interpolation = "SMOOTH"; }),
              HasSubstr("sampler is invalid"));
  EXPECT_THAT(with([](Animated& a) { a.nodes = R"({"children": [0]})"; }),
              HasSubstr("form a cycle"));
  EXPECT_THAT(with([](Animated& a) {
                a.nodes = R"({"children": [1]}, {"children": [2]}, {"children": [1]})";
              }),
              HasSubstr("two parents"));
  EXPECT_THAT(with([](Animated& a) { a.nodes = R"({"children": [7]})"; }), HasSubstr("missing"));
  EXPECT_THAT(with([](Animated& a) {
                a.path = "rotation";
                a.type = "VEC4";
                a.values.assign(8, 0.0F);
              }),
              HasSubstr("zero quaternion"));
  std::string cut = good.text();
  cut.resize(cut.size() / 2);
  EXPECT_NE(message_of(cut), "");
  EXPECT_THAT(message_of(std::string("glTF\x01\0\0\0 12345678901234", 23)), HasSubstr("version"));
}

// Thousands of buffers of one file load it once; a pipe is rejected; a missing file is named with
// its glTF.
TEST(GltfSceneTest, ReadsAnExternalBufferOnce) {
  constexpr int kBuffers = 200;
  const TemporaryFolder folder;
  const std::string name = (folder.path() / "test.gltf").string();
  folder.write("big.bin", packed<float>({0, 1}) + std::string(std::size_t{1} << 20U, '\0'));
  const auto text = [&](const std::string& uri) {
    std::string buffers, views, accessors, channels, samplers, nodes = R"({"name": "Hips"})";
    for (int i = 0; i < kBuffers; ++i) {
      const char* comma = i == 0 ? "" : ",";
      buffers += fmt::format(R"({}{{"byteLength": 32, "uri": "{}"}})", comma, uri);
      views += fmt::format(R"({}{{"buffer": {}, "byteLength": 32}})", comma, i);
      accessors +=
          fmt::format(R"({}{{"bufferView": {}, "componentType": 5126, "count": 2, "type": "{}"}})",
                      comma, i, i == 0 ? "SCALAR" : "VEC3");
      nodes += ",{}";
      if (i == 0) continue;
      comma = i == 1 ? "" : ",";
      channels +=
          fmt::format(R"({}{{"sampler": {}, "target": {{"node": {}, "path": "translation"}}}})",
                      comma, i - 1, i - 1);
      samplers += fmt::format(R"({}{{"input": 0, "output": {}}})", comma, i);
    }
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "nodes": [{}], "buffers": [{}],
"bufferViews": [{}], "accessors": [{}], "animations": [{{"channels": [{}], "samplers": [{}]}}]}})",
        nodes, buffers, views, accessors, channels, samplers);
  };
  // Four times the file size, for two hundred buffers.
  const auto once = read_gltf(text("big.bin"), name, std::size_t{4} << 20U);
  EXPECT_TRUE(once.has_value()) << once.error().message;
  const auto too_large = read_gltf(text("big.bin"), name, std::size_t{1} << 19U);
  ASSERT_FALSE(too_large);
#ifndef _WIN32
  ASSERT_EQ(::mkfifo((folder.path() / "pipe.bin").c_str(), 0600), 0);
#endif
  for (const char* uri : {"pipe.bin", "missing.bin"}) {
    const auto refused = read_gltf(text(uri), name, kGltfMemory);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("is missing or not a regular file"));
    EXPECT_THAT(refused.error().location.file, HasSubstr("test.gltf"));
  }
}

TEST(GltfSceneTest, LimitsTheNumberOfTakes) {
  Animated moved;
  moved.times = {0, 1};
  moved.values = {0, 0, 0, 1, 1, 1};
  for (int i = 0; i < 5000; ++i) moved.nodes += ",{}";
  std::string text = moved.text();
  std::string empty;
  for (int i = 0; i < 5000; ++i) empty += R"({"channels": [], "samplers": []},)";
  text.insert(text.find(R"({"name": "move")"), empty);
  EXPECT_THAT(message_of(text), HasSubstr("5001 animations of 5001 nodes"));
}

// Each leaf is visited once; more joints than a body has are rejected.
TEST(GltfSceneTest, LimitsTheNumberOfJoints) {
  Animated moved;
  moved.times = {0, 1};
  moved.values = {0, 0, 0, 1, 1, 1};
  const auto with_leaves = [&](int count) {
    std::string children, joints, leaves;
    for (int i = 1; i <= count; ++i) {
      children += fmt::format("{}{}", i == 1 ? "" : ",", i);
      joints += fmt::format(",{}", i);
      leaves += R"(,{"scale": [1, 1, 2]})";
    }
    moved.nodes = fmt::format(R"({{"name": "Hips", "children": [{}]}}{})", children, leaves);
    moved.more = fmt::format(R"(, "skins": [{{"joints": [0{}]}}])", joints);
    return message_of(moved.text());
  };
  EXPECT_EQ(with_leaves(4000), "");
  EXPECT_THAT(with_leaves(60000), HasSubstr("60001 joints; 5000 are allowed"));
}

// Many samplers that share numbers must not exhaust the memory.
TEST(GltfSceneTest, LimitsRepeatedReadsOfTheSameBytes) {
  Animated moved;
  moved.times.resize(20000);
  for (std::size_t i = 0; i < moved.times.size(); ++i) moved.times[i] = static_cast<float>(i);
  moved.values.resize(3 * moved.times.size());
  for (int i = 1; i < 9000; ++i) moved.nodes += ",{}";
  std::string text = moved.text();
  std::string channels, samplers;
  for (int i = 0; i < 9000; ++i) {
    channels +=
        fmt::format(R"({{"sampler": {}, "target": {{"node": {}, "path": "translation"}}}},)", i, i);
    samplers += R"({"input": 0, "output": 1},)";
  }
  channels.pop_back();
  samplers.pop_back();
  const std::size_t begin = text.find("\"animations\"");
  text.resize(begin);
  text += fmt::format(R"("animations": [{{"channels": [{}], "samplers": [{}]}}]}})", channels,
                      samplers);
  EXPECT_THAT(message_of(text), HasSubstr("too often"));
}

TEST(GltfSceneTest, RejectsTwoChannelsOfOneProperty) {
  Animated moved;
  moved.times = {0, 1};
  moved.values = {0, 0, 0, 1, 1, 1};
  std::string text = moved.text();
  const std::string channel = R"({"sampler": 0, "target": {"node": 0, "path": "translation"}})";
  text.insert(text.find(channel), channel + ",");
  EXPECT_THAT(message_of(text), HasSubstr("two channels of an animation move the translation"));
  // Another property is not the same.
  text = moved.text();
  text.insert(text.find(channel), R"({"sampler": 0, "target": {"node": 0, "path": "scale"}},)");
  EXPECT_THAT(message_of(text), ::testing::Not(HasSubstr("two channels")));
}

TEST(GltfSceneTest, RejectsOtherVersionsAndUnknownRequirements) {
  Animated moved;
  moved.times = {0, 1};
  moved.values = {0, 0, 0, 1, 1, 1};
  const std::string good = moved.text();
  const auto with_version = [&](const std::string& version) {
    std::string text = good;
    text.replace(text.find(R"("2.0")"), 5, version);
    return message_of(text);
  };
  EXPECT_THAT(with_version(R"("1.0")"), HasSubstr("expected version 2, found version 1.0"));
  EXPECT_THAT(with_version("1"), HasSubstr("found version 1"));
  EXPECT_EQ(with_version(R"("2.1")"), "");
  moved.more = R"(, "extensionsRequired": ["KHR_materials_unlit", "KHR_draco_mesh_compression",
"KHR_texture_transform", "EXT_meshopt_compression", "KHR_mesh_quantization", "VRMC_vrm"])";
  EXPECT_EQ(message_of(moved.text()), "");
  moved.more = R"(, "extensionsRequired": ["KHR_materials_unlit", "ACME_bones", "ACME_time"])";
  EXPECT_THAT(message_of(moved.text()),
              HasSubstr("it requires the extensions ACME_bones, ACME_time"));
  // Meshes may be compressed, but not the numbers that are read.
  moved.more = R"(, "extensionsRequired": ["EXT_meshopt_compression"])";
  std::string packed_keys = moved.text();
  const std::string view = R"("bufferViews": [{"buffer": 0,)";
  packed_keys.replace(packed_keys.find(view), view.size(),
                      view + R"( "extensions": {"EXT_meshopt_compression": {"buffer": 0}},)");
  EXPECT_THAT(message_of(packed_keys), HasSubstr("compressed (EXT_meshopt_compression)"));
}

}  // namespace
}  // namespace retarget
