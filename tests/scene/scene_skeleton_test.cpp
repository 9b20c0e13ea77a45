#include "formats/scene/scene_skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <fmt/format.h>

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Adds a chain of nodes below a node.
int add_chain(SceneGraph& scene, const std::string& name, int parent, int count, bool are_bones,
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

SceneGraph scene_of_one_take() {
  SceneGraph scene;
  scene.takes.push_back({"take", 0.0, 1.0, {}, {}});
  return scene;
}

TEST(SceneSkeletonTest, ChoosesTheMovingSkeleton) {
  SceneGraph scene = scene_of_one_take();
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

TEST(SceneSkeletonTest, RequiresAChoiceBetweenTwoDancers) {
  SceneGraph scene = scene_of_one_take();
  const int first = add_chain(scene, "Armature", -1, 1, false, false);
  add_chain(scene, "hips", first, 15, true, true);
  const int second = add_chain(scene, "Armature.001", -1, 1, false, false);
  const int hips = add_chain(scene, "hips", second, 15, true, true);
  const auto both = choose_skeleton(scene, 0, "", "a.fbx");
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().message, HasSubstr("2 possible skeletons"));
  // By a node above the root if the roots have equal names.
  EXPECT_EQ(choose_skeleton(scene, 0, "Armature.001", "a.fbx")->joints.front(), hips);
  EXPECT_THAT(both.error().hint, HasSubstr("\"Armature\", \"Armature.001\""));
}

TEST(SceneSkeletonTest, ChoosesBetweenEqualNamesByNumber) {
  SceneGraph scene = scene_of_one_take();
  const int first = add_chain(scene, "hips", -1, 15, true, true);
  const int second = add_chain(scene, "hips", -1, 15, true, true);
  for (const char* root : {"", "hips"}) {
    const auto both = choose_skeleton(scene, 0, root, "a.fbx");
    ASSERT_FALSE(both);
    EXPECT_THAT(both.error().hint, HasSubstr("NUMBER: 1, 2"));
  }
  EXPECT_EQ(choose_skeleton(scene, 0, "1", "a.fbx")->joints.front(), first);
  EXPECT_EQ(choose_skeleton(scene, 0, "2", "a.fbx")->joints.front(), second);
  EXPECT_FALSE(choose_skeleton(scene, 0, "3", "a.fbx"));
  // A name comes before a number.
  scene.nodes[static_cast<std::size_t>(first)].name = "2";
  EXPECT_EQ(choose_skeleton(scene, 0, "2", "a.fbx")->joints.front(), first);
}

// The part of the warning about a choice that names the alternatives.
std::string told_of_others(const SceneGraph& scene, int take, const std::string& root = {}) {
  const auto chosen = choose_skeleton(scene, take, root, "a.fbx");
  EXPECT_TRUE(chosen);
  return other_actors_text(scene, *chosen, take);
}

TEST(SceneSkeletonTest, WarnsAboutASecondActorWithLessMovement) {
  SceneGraph scene = scene_of_one_take();
  add_chain(scene, "Alice", -1, 60, true, true);
  add_chain(scene, "Bob", -1, 20, true, true);
  const std::string text = told_of_others(scene, 0);
  EXPECT_THAT(text, HasSubstr("another skeleton moves: \"Bob\""));
  EXPECT_THAT(spell_options(text), HasSubstr("root NAME reads another skeleton"));
  EXPECT_THAT(text, Not(HasSubstr("take")));
}

TEST(SceneSkeletonTest, WarnsAboutASecondActorInAnotherTake) {
  SceneGraph scene = scene_of_one_take();
  add_chain(scene, "Alice", -1, 20, true, true);
  add_chain(scene, "Bob", -1, 20, true, false);
  SceneTake take{"Bob|walk", 0.0, 1.0, {}, {}};
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    take.has_keys.push_back(i >= 20);
    take.moves.push_back(i >= 20);
  }
  scene.takes.push_back(take);
  const std::string text = told_of_others(scene, 0);
  EXPECT_THAT(text, HasSubstr("another skeleton moves: \"Bob\" (take \"Bob|walk\")"));
  EXPECT_THAT(spell_options(text), HasSubstr("root NAME with take NAME reads another skeleton"));
}

TEST(SceneSkeletonTest, NamesActorsWithEqualRootsByANodeAbove) {
  SceneGraph scene = scene_of_one_take();
  const int first = add_chain(scene, "Armature", -1, 1, false, false);
  add_chain(scene, "hips", first, 60, true, true);
  const int second = add_chain(scene, "Armature.001", -1, 1, false, false);
  add_chain(scene, "hips", second, 20, true, true);
  EXPECT_THAT(told_of_others(scene, 0), HasSubstr("another skeleton moves: \"Armature.001\""));
}

TEST(SceneSkeletonTest, IgnoresStatuesAndProps) {
  SceneGraph scene = scene_of_one_take();
  add_chain(scene, "Alice", -1, 60, true, true);
  add_chain(scene, "statue", -1, 40, true, false);
  add_chain(scene, "sword", -1, 4, true, true);
  EXPECT_EQ(told_of_others(scene, 0), "");
}

TEST(SceneSkeletonTest, KeepsHelpersBetweenJoints) {
  SceneGraph scene = scene_of_one_take();
  const int hips = add_chain(scene, "hips", -1, 11, true, true);
  const int helper = add_chain(scene, "helper", hips + 10, 1, false, false);
  add_chain(scene, "foot", helper, 1, true, false);
  add_chain(scene, "hat", hips + 10, 1, false, false);
  const auto chosen = choose_skeleton(scene, 0, "", "a.fbx");
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->joints.size(), 13U);
}

TEST(SceneSkeletonTest, UsesPlainNodesWithoutLimbs) {
  SceneGraph scene = scene_of_one_take();
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
