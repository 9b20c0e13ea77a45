#include "scene/scene_skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <fmt/format.h>

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// adds a chain of nodes below a node
int add_chain(Scene& scene, const std::string& name, int parent, int count, bool are_bones,
              bool move) {
  for (int i = 0; i < count; ++i) {
    SceneNode node;
    node.name = i == 0 ? name : fmt::format("{}_{}", name, i);
    node.parent = i == 0 ? parent : static_cast<int>(scene.nodes.size()) - 1;
    node.is_bone = are_bones;
    scene.nodes.push_back(node);
    scene.takes.at(0).has_keys.push_back(move);
    scene.takes.at(0).moves.push_back(move);
  }
  return static_cast<int>(scene.nodes.size()) - count;
}

Scene scene_of_one_take() {
  Scene scene;
  scene.takes.push_back({"take", 0.0, 1.0, {}, {}});
  return scene;
}

TEST(SceneSkeletonTest, TakesTheOneThatMoves) {
  Scene scene = scene_of_one_take();
  add_chain(scene, "statue", -1, 20, true, false);
  const int dancer = add_chain(scene, "dancer", -1, 12, true, true);
  const auto chosen = choose_skeleton(scene, 0, "", "a.fbx");
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(chosen->joints.front(), dancer);
  EXPECT_EQ(chosen->joints.size(), 12U);
  EXPECT_THAT(chosen->others, ElementsAre("statue"));
  EXPECT_EQ(choose_skeleton(scene, 0, "statue", "a.fbx")->joints.size(), 20U);
  const auto missing = choose_skeleton(scene, 0, "singer", "a.fbx");
  EXPECT_EQ(missing.error().kind, ErrorKind::kUsage);
}

TEST(SceneSkeletonTest, AsksWhichOfTwoDancers) {
  Scene scene = scene_of_one_take();
  const int first = add_chain(scene, "Armature", -1, 1, false, false);
  add_chain(scene, "hips", first, 15, true, true);
  const int second = add_chain(scene, "Armature.001", -1, 1, false, false);
  const int hips = add_chain(scene, "hips", second, 15, true, true);
  const auto both = choose_skeleton(scene, 0, "", "a.fbx");
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().message, HasSubstr("2 skeletons"));
  // by a node above the root where the roots' names are the same
  EXPECT_EQ(choose_skeleton(scene, 0, "Armature.001", "a.fbx")->joints.front(), hips);
}

TEST(SceneSkeletonTest, KeepsHelpersBetweenJoints) {
  Scene scene = scene_of_one_take();
  const int hips = add_chain(scene, "hips", -1, 11, true, true);
  const int helper = add_chain(scene, "helper", hips + 10, 1, false, false);
  add_chain(scene, "foot", helper, 1, true, false);
  add_chain(scene, "hat", hips + 10, 1, false, false);
  const auto chosen = choose_skeleton(scene, 0, "", "a.fbx");
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->joints.size(), 13U);
}

TEST(SceneSkeletonTest, TakesPlainNodesWhereThereAreNoLimbs) {
  Scene scene = scene_of_one_take();
  add_chain(scene, "world", -1, 1, false, false);
  const int hips = add_chain(scene, "hips", 0, 10, false, true);
  add_chain(scene, "toe", hips + 9, 2, false, false);
  SceneNode camera;
  camera.parent = 0;
  camera.is_object = true;
  scene.nodes.push_back(camera);
  scene.takes[0].has_keys.push_back(false);
  scene.takes[0].moves.push_back(false);
  const auto chosen = choose_skeleton(scene, 0, "", "a.glb");
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(chosen->joints.front(), hips);
  EXPECT_EQ(chosen->joints.size(), 12U);
}

}  // namespace
}  // namespace retarget
