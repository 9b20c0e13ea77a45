#include "formats/scene/read_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/option_name.h"
#include "fbx_text.h"
#include "formats/containers/file_kind.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::AngleAxisd, Eigen::Matrix3d, Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t kMemory = std::size_t{1} << 30U;

Matrix3d turn(int axis, double degrees) {
  return AngleAxisd(degrees * std::numbers::pi / 180.0, Vector3d::Unit(axis)).toRotationMatrix();
}

// The first axis of an order rotates first and is therefore last in the product.
Matrix3d in_order(const std::string& order, const Vector3d& degrees) {
  Matrix3d rotation = Matrix3d::Identity();
  for (const char axis : order) rotation = turn(axis - 'X', degrees[axis - 'X']) * rotation;
  return rotation;
}

SceneGraph fbx_scene(const FbxText& file) {
  return value_of(read_fbx(file.text(), "test.fbx", kMemory));
}

int node_of(const SceneGraph& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].name == name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no node " << name;
  return 0;
}

TEST(FbxSceneTest, AppliesEveryRotationOrder) {
  const char* orders[] = {"XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX"};
  for (int order = 0; order < 6; ++order) {
    FbxText file;
    const int limb = file.node("limb", 0, {1, 2, 3}, {}, order);
    file.take("turn", 0, 1);
    file.keys(limb, "Lcl Rotation", {{0, {0, 0, 0}}, {1, {40, 60, -100}}});
    const SceneGraph scene = fbx_scene(file);
    ASSERT_EQ(scene.takes.size(), 1U);
    const NodeTransform half = scene.motion->at(0, node_of(scene, "limb"), 0.5);
    const Matrix3d expected = in_order(orders[order], {20, 30, -50});
    EXPECT_LT((half.rotation.toRotationMatrix() - expected).norm(), 1e-9) << orders[order];
    EXPECT_LT((half.translation - Vector3d(1, 2, 3)).norm(), 1e-12);
  }
}

// Autodesk, "FBX SDK Programmer's Guide", "Computing transformation matrices":
// T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1
TEST(FbxSceneTest, AppliesPivotsAndPreAndPostRotations) {
  FbxText file;
  const int limb = file.node("limb", 0, {1, 2, 3},
                             {{"PreRotation", {30, -20, 10}},
                              {"PostRotation", {-15, 25, 40}},
                              {"RotationOffset", {0.1, 0.2, 0.3}},
                              {"RotationPivot", {0.5, -0.4, 0.3}},
                              {"ScalingOffset", {0.2, 0.1, -0.1}},
                              {"ScalingPivot", {-0.3, 0.6, 0.2}},
                              {"Lcl Scaling", {2, 2, 2}}},
                             4);
  file.take("turn", 0, 1);
  file.keys(limb, "Lcl Rotation", {{0, {0, 0, 0}}, {1, {80, -60, 30}}});
  const SceneGraph scene = fbx_scene(file);
  const NodeTransform found = scene.motion->at(0, node_of(scene, "limb"), 0.25);

  const auto moved = [](double x, double y, double z) {
    return Eigen::Affine3d(Eigen::Translation3d(x, y, z));
  };
  const auto turned = [](const Matrix3d& rotation) {
    Eigen::Affine3d affine = Eigen::Affine3d::Identity();
    affine.linear() = rotation;
    return affine;
  };
  // Pre- and post-rotations have the order XYZ, independent of the limb's own.
  const Matrix3d before = in_order("XYZ", {30, -20, 10}), after = in_order("XYZ", {-15, 25, 40});
  const Eigen::Affine3d expected =
      moved(1, 2, 3) * moved(0.1, 0.2, 0.3) * moved(0.5, -0.4, 0.3) * turned(before) *
      turned(in_order("ZXY", {20, -15, 7.5})) * turned(after.transpose()) * moved(-0.5, 0.4, -0.3) *
      moved(0.2, 0.1, -0.1) * moved(-0.3, 0.6, 0.2) * Eigen::Scaling(2.0) * moved(0.3, -0.6, -0.2);
  EXPECT_LT((found.translation - expected.translation()).norm(), 1e-9);
  EXPECT_LT((found.rotation.toRotationMatrix() * 2.0 - expected.linear()).norm(), 1e-9);
  EXPECT_LT((found.scale - Vector3d(2, 2, 2)).norm(), 1e-12);
}

TEST(FbxSceneTest, ReadsUnitAxesAndRate) {
  const SceneGraph maya = fbx_scene(FbxText({1, 1, 1.0, 11}));
  EXPECT_DOUBLE_EQ(maya.metres_per_unit, 0.01);
  EXPECT_EQ(*maya.up, Vector3d::UnitY());
  EXPECT_DOUBLE_EQ(maya.fps, 24.0);
  const SceneGraph unreal = fbx_scene(FbxText({2, 1, 1.0, 6}));
  EXPECT_EQ(*unreal.up, Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(unreal.fps, 30.0);
  const SceneGraph metres = fbx_scene(FbxText({2, 1, 100.0, 6}));
  EXPECT_DOUBLE_EQ(metres.metres_per_unit, 1.0);
}

// A helper above the root moves its children; a mesh is not a joint.
TEST(FbxSceneTest, KeepsTheTransformsOfHelpersAboveTheRoot) {
  FbxText file;
  const int helper =
      file.node("helper", 0, {10, 0, 0}, {{"Lcl Scaling", {0.5, 0.5, 0.5}}}, 0, "Null");
  const int root = file.node("Hips", helper, {0, 4, 0});
  const int limb = file.node("Leg", root, {0, -2, 0});
  file.node("cloth", limb, {0, 0, 0}, {}, 0, "Mesh");
  file.take("turn", 0, 1);
  file.keys(helper, "Lcl Translation", {{0, {10, 0, 0}}, {1, {12, 0, 0}}});
  file.keys(root, "Lcl Rotation", {{0, {0, 0, 0}}, {1, {0, 0, 90}}});
  const auto clip = value_of(read_scene(file.text(), "test.fbx"));
  EXPECT_THAT(clip.skeleton().names(), ElementsAre("Hips", "Leg"));
  ASSERT_EQ(clip.frame_count(), 31);
  EXPECT_LT((clip.translation(0, 0) - Vector3d(10, 2, 0)).norm(), 1e-9);
  EXPECT_LT((clip.translation(30, 0) - Vector3d(12, 2, 0)).norm(), 1e-9);
  // The scale above halves the leg.
  EXPECT_LT((clip.skeleton().joint(1).offset - Vector3d(0, -1, 0)).norm(), 1e-9);
  EXPECT_FALSE(clip.skeleton().joint(1).has_position_channels());
  EXPECT_LT((clip.rotations(30)[0].toRotationMatrix() - turn(2, 90)).norm(), 1e-9);
}

TEST(FbxSceneTest, ReadsTheRequestedTake) {
  FbxText file;
  const int root = file.node("Hips", 0, {0, 0, 0});
  file.take("empty", 0, 9);
  file.take("short", 0, 0.5);
  file.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {0.5, {1, 0, 0}}});
  file.take("long", 0, 1);
  file.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {1, {0, 7, 0}}});
  SceneReadOptions options;
  EXPECT_EQ(read_scene(file.text(), "test.fbx", options)->frame_count(), 31);
  for (const char* name : {"short", "2"}) {
    options.take = name;
    const auto clip = value_of(read_scene(file.text(), "test.fbx", options));
    EXPECT_EQ(clip.frame_count(), 16);
    EXPECT_EQ(clip.translation(15, 0), Vector3d(1, 0, 0));
    EXPECT_THAT(clip.origin().choices, HasSubstr("\"short\" (2 of 3)"));
    EXPECT_THAT(clip.origin().takes, ElementsAre("empty", "short", "long"));
  }
  options.take = "walk";
  const auto missing = read_scene(file.text(), "test.fbx", options);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(missing.error().message, HasSubstr("empty, short, long"));
}

// A camera that moves for half a minute, a pose held for ten seconds, a walk of two.
TEST(FbxSceneTest, ReadsTheTakeThatMovesTheSkeleton) {
  for (const bool are_limbs : {true, false}) {
    FbxText file;
    std::vector<int> limbs;
    for (int i = 0; i < 12; ++i) {
      limbs.push_back(file.node("limb" + std::to_string(i), i == 0 ? 0 : limbs.back(), {0, 1, 0},
                                {}, 0, are_limbs ? "LimbNode" : "Null"));
    }
    const int camera = file.node("camera", 0, {0, 0, 9}, {}, 0, "Null");
    file.take("flight", 0, 30);
    file.keys(camera, "Lcl Translation", {{0, {0, 0, 9}}, {30, {9, 0, 9}}});
    file.take("pose", 0, 10);
    for (const int limb : limbs) {
      file.keys(limb, "Lcl Rotation", {{0, {10, 0, 0}}, {10, {10.0001, 0, 0}}});
    }
    file.take("walk", 0, 20);
    file.keys(camera, "Lcl Translation", {{0, {0, 0, 9}}, {20, {9, 0, 9}}});
    for (const int limb : limbs) {
      file.keys(limb, "Lcl Rotation", {{1, {0, 0, 0}}, {3, {30, 0, 0}}});
    }
    const auto clip = value_of(read_scene(file.text(), "test.fbx"));
    EXPECT_THAT(clip.origin().choices, HasSubstr("\"walk\" (3 of 3)"));
    EXPECT_EQ(clip.frame_count(), 61);
    EXPECT_EQ(clip.skeleton().joint_count(), 12);
    EXPECT_TRUE(clip.origin().warnings.empty());

    SceneReadOptions options;
    options.take = "pose";
    const auto pose = value_of(read_scene(file.text(), "test.fbx", options));
    ASSERT_EQ(pose.origin().warnings.size(), 1U);
    EXPECT_THAT(pose.origin().warnings[0].message, HasSubstr("the take \"pose\" has no movement"));
    options.take = "wolk";
    EXPECT_THAT(read_scene(file.text(), "test.fbx", options).error().message,
                HasSubstr("did you mean \"walk\""));
    if (!are_limbs) continue;
    options.take = "flight";
    const auto flight = read_scene(file.text(), "test.fbx", options);
    ASSERT_FALSE(flight);
    EXPECT_EQ(flight.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(flight.error().message, HasSubstr("Takes that have: walk"));
  }
}

TEST(FbxSceneTest, IsRecognisedAfterCommentsAndAByteOrderMark) {
  const std::string text = FbxText().text();
  const std::string rest = text.substr(text.find('\n') + 1);
  EXPECT_EQ(file_type("\xEF\xBB\xBF" + text).kind, FileKind::kFbx);
  EXPECT_TRUE(read_fbx("\xEF\xBB\xBF" + text, "marked.fbx", kMemory).has_value());
  EXPECT_EQ(file_type(";\n\n; made by hand\n" + rest).kind, FileKind::kFbx);
  EXPECT_EQ(file_type(rest).kind, FileKind::kFbx);
  EXPECT_EQ(file_type("; a list of names\nHips\n").kind, FileKind::kOther);
  EXPECT_EQ(file_type("<?xml version='1.0'?><!-- " + std::string(9000, 'x') + " --><mvnx>").kind,
            FileKind::kMvnx);
  EXPECT_EQ(file_type("<?xml version='1.0'?><!-- <mvnx> --><html>").kind, FileKind::kForeign);
}

TEST(FbxSceneTest, NamesTheLocationOfAStrayKey) {
  FbxText file;
  const int root = file.node("Hips", 0, {0, 0, 0});
  file.take("move", 0, 3e7);
  file.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {0.1, {1, 0, 0}}, {3e7, {1, 0, 0}}});
  EXPECT_THAT(read_scene(file.text(), "far.fbx").error().hint,
              HasSubstr("between 0.1 s and 3e+07 s"));
}

TEST(FbxSceneTest, ReportsFewKeysInsteadOfUnevenKeys) {
  FbxText file;
  const int root = file.node("Hips", 0, {0, 0, 0});
  file.take("pose", 0, 1);
  file.keys(root, "Lcl Translation", {{0, {1, 0, 0}}});
  std::string text = file.text();
  const std::string rate = "\"TimeMode\", \"enum\", \"\", \"\",6";
  text.replace(text.find(rate), rate.size(), "\"TimeMode\", \"enum\", \"\", \"\",14");
  const auto clip = value_of(read_scene(text, "test.fbx"));
  EXPECT_EQ(clip.frame_count(), 1);
  EXPECT_THAT(clip.origin().choices, ::testing::Not(HasSubstr("evenly")));
}

TEST(FbxSceneTest, SamplesAtTheRequestedRate) {
  FbxText file;
  const int root = file.node("Hips", 0, {0, 0, 0});
  file.take("move", 0, 1);
  file.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {0.4, {4, 0, 0}}, {1, {10, 0, 0}}});
  SceneReadOptions options;
  options.source_fps = 120.0;
  const auto clip = value_of(read_scene(file.text(), "test.fbx", options));
  ASSERT_EQ(clip.frame_count(), 121);
  EXPECT_NEAR(clip.translation(30, 0).x(), 2.5, 1e-9);
}

TEST(FbxSceneTest, RejectsFilesWithoutMotion) {
  FbxText still;
  still.node("Hips", 0, {0, 0, 0});
  const auto without = read_scene(still.text(), "still.fbx");
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message, HasSubstr("holds no animation"));
  // An option of `inspect`.
  EXPECT_THAT(without.error().hint, HasSubstr("inspect " OPTION("skeleton") " shows"));
  SceneReadOptions skeleton;
  skeleton.skeleton_only = true;
  EXPECT_EQ(read_scene(still.text(), "still.fbx", skeleton)->skeleton().joint_count(), 1);

  FbxText mirror;
  const int root = mirror.node("Hips", 0, {0, 0, 0}, {{"Lcl Scaling", {-1, 1, 1}}});
  mirror.take("move", 0, 1);
  mirror.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {1, {1, 0, 0}}});
  EXPECT_THAT(read_scene(mirror.text(), "mirror.fbx").error().message, HasSubstr("negative scale"));

  // A key a thousand years later.
  FbxText ages;
  const int slow = ages.node("Hips", 0, {0, 0, 0});
  ages.take("move", 0, 3e7);
  ages.keys(slow, "Lcl Translation", {{0, {0, 0, 0}}, {3e7, {1, 0, 0}}});
  EXPECT_THAT(read_scene(ages.text(), "ages.fbx").error().message,
              HasSubstr("exceed the memory limit"));
}

TEST(FbxSceneTest, WarnsAboutNonUniformOrChangingScale) {
  FbxText file;
  const int root = file.node("Hips", 0, {0, 0, 0}, {{"Lcl Scaling", {1, 2, 1}}});
  file.node("Leg", root, {0, -1, 0});
  file.take("grow", 0, 1);
  file.keys(root, "Lcl Scaling", {{0, {1, 2, 1}}, {1, {2, 4, 2}}});
  const auto clip = value_of(read_scene(file.text(), "test.fbx"));
  ASSERT_EQ(clip.origin().warnings.size(), 2U);
  EXPECT_THAT(clip.origin().warnings[0].message, HasSubstr("non-uniform"));
  EXPECT_THAT(clip.origin().warnings[1].message, HasSubstr("changes during the motion"));
}

// ufbx reads a file that ends inside its last section.
TEST(FbxSceneTest, RejectsFilesThatAreCutOff) {
  FbxText file;
  const int root = file.node("Hi;ps { \n", 0, {0, 0, 0});
  file.take("move", 0, 1);
  file.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {1, {1, 0, 0}}});
  const std::string text = file.text() + "; a comment with {\n";
  ASSERT_TRUE(read_scene(text, "whole.fbx").has_value());
  const std::size_t last = text.find("Connections: {");
  for (const std::size_t end : {text.rfind('}'), last + 20, text.find("\tC: \"OP\"")}) {
    const auto cut = read_scene(text.substr(0, end), "cut.fbx");
    ASSERT_FALSE(cut);
    EXPECT_THAT(cut.error().message, HasSubstr("ends inside \"Connections\""));
    EXPECT_THAT(cut.error().hint, HasSubstr("the file is truncated"));
    EXPECT_EQ(cut.error().location.file, "cut.fbx");
    EXPECT_GT(cut.error().location.line, 20U);
  }
}

TEST(FbxSceneTest, RejectsKeysThatDoNotAscend) {
  FbxText file;
  const int root = file.node("Hips", 0, {0, 0, 0});
  file.take("move", 0, 1);
  file.keys(root, "Lcl Translation", {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {0.5, {2, 0, 0}}});
  const auto clip = read_scene(file.text(), "test.fbx");
  ASSERT_FALSE(clip);
  EXPECT_THAT(clip.error().message, HasSubstr("key times of \"Hips\" do not ascend"));
}

// Without a skin, the rest pose that is a frame of any take was shown during the export.
TEST(FbxSceneTest, FindsTheRestPoseInAllTakes) {
  const auto first_turn = [](const char* take, double degrees) {
    FbxText file;
    const int root = file.node("Hips", 0, {0, 0, 0}, {{"Lcl Rotation", {0, 0, degrees}}});
    file.node("Leg", root, {0.3, -2, 0.2});
    file.take("A", 0, 1);
    file.keys(root, "Lcl Rotation", {{0, {0, 0, 20}}, {1, {0, 0, 50}}});
    file.take("B", 0, 1);
    file.keys(root, "Lcl Rotation", {{0, {0, 0, 60}}, {1, {0, 0, 90}}});
    file.take("pose", 0, 1);
    file.keys(root, "Lcl Rotation", {{0, {0, 0, 5}}, {1, {0, 0, 5}}});
    SceneReadOptions options;
    options.take = take;
    const auto clip = value_of(read_scene(file.text(), "test.fbx", options));
    const AngleAxisd found(clip.rotations(0)[0]);
    return std::round(found.angle() * 180.0 / std::numbers::pi);
  };
  EXPECT_EQ(first_turn("A", 20), 20);
  EXPECT_EQ(first_turn("B", 20), 60);
  // A frame of no take is the rest pose; so is one that a take holds as a reference.
  EXPECT_EQ(first_turn("B", 10), 50);
  EXPECT_EQ(first_turn("B", 5), 55);
}

// Shoulders that hang from the neck and keep their place when the head turns, as in 3ds Max.
TEST(FbxSceneTest, JointsThatTranslateHaveTheirOffsetOfTheRestPose) {
  FbxText file;
  const int neck = file.node("Neck", 0, {0, 10, 0});
  const int shoulder = file.node("Shoulder", neck, {2, 0, 0});
  file.node("Arm", shoulder, {3, 0, 0});
  file.take("turn", 0, 1);
  file.keys(neck, "Lcl Rotation", {{0, {0, 40, 0}}, {1, {0, 0, 0}}});
  const double angle = 40.0 * std::numbers::pi / 180.0;
  file.keys(shoulder, "Lcl Translation",
            {{0, {2.2 * std::cos(angle), 0, 2.2 * std::sin(angle)}}, {1, {2.2, 0, 0}}});
  const auto clip = value_of(read_scene(file.text(), "test.fbx"));
  EXPECT_TRUE(clip.skeleton().joint(1).has_position_channels());
  // The median of the bones' lengths is between both.
  EXPECT_LT((clip.skeleton().joint(1).offset - Vector3d(2.1, 0, 0)).norm(), 1e-6);
  EXPECT_NEAR(clip.translation(0, 1).norm(), 2.2, 1e-6);

  // Without a length in the rest pose, the first frame gives the offset.
  FbxText flat;
  const int hips = flat.node("Hips", 0, {0, 10, 0});
  const int leg = flat.node("Leg", hips, {0, 0, 0});
  flat.take("move", 0, 1);
  flat.keys(leg, "Lcl Translation", {{0, {0, -4, 0}}, {1, {0, -5, 0}}});
  const auto moved = value_of(read_scene(flat.text(), "flat.fbx"));
  EXPECT_LT((moved.skeleton().joint(1).offset - Vector3d(0, -4, 0)).norm(), 1e-6);
}

}  // namespace
}  // namespace retarget
