#include "formats/scene/scene_skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/scene/scene_takes.h"
#include "formats/scene/skeleton_shape.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
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
  const auto chosen = value_of(choose_skeleton(scene, 0, "", "a.fbx"));
  EXPECT_EQ(chosen.joints.front(), dancer);
  EXPECT_EQ(chosen.joints.size(), 12U);
  EXPECT_THAT(chosen.others, ElementsAre("statue"));
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
  const auto chosen = value_of(choose_skeleton(scene, take, root, "a.fbx"));
  return other_actors_text(scene, chosen, take);
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
  const auto chosen = value_of(choose_skeleton(scene, 0, "", "a.fbx"));
  EXPECT_EQ(chosen.joints.size(), 13U);
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
  const auto chosen = value_of(choose_skeleton(scene, 0, "", "a.glb"));
  EXPECT_EQ(chosen.joints.front(), hips);
  EXPECT_EQ(chosen.joints.size(), 12U);
}

// Adds a take in which these nodes move.
void add_take(SceneGraph& scene, const std::string& name, const std::vector<int>& moving) {
  SceneTake take{name, 0.0, 1.0, {}, {}};
  take.moves.resize(scene.nodes.size(), false);
  for (const int node : moving) take.moves.at(static_cast<std::size_t>(node)) = true;
  take.has_keys = take.moves;
  scene.takes.push_back(take);
}

// Keys of all nodes at the begin and the end of a take.
class EndKeys : public SceneMotion {
 public:
  explicit EndKeys(std::vector<double> lengths) : lengths_(std::move(lengths)) {}
  [[nodiscard]] NodeTransform at(int, int, double) const override { return {}; }
  [[nodiscard]] std::vector<double> key_times(int take, const std::vector<bool>&) const override {
    return {0.0, lengths_.at(static_cast<std::size_t>(take))};
  }

 private:
  std::vector<double> lengths_;
};

// Places each node of a chain this far from the one above it.
void place_chain(SceneGraph& scene, int first, int count, const Eigen::Vector3d& step) {
  for (int i = first; i < first + count; ++i) {
    scene.nodes.at(static_cast<std::size_t>(i)).rest.translation = step;
  }
}

std::vector<int> numbers_from(int first, int count) {
  std::vector<int> numbers;
  for (int i = first; i < first + count; ++i) numbers.push_back(i);
  return numbers;
}

TEST(SceneSkeletonTest, PrefersTheTakeThatMovesTheBody) {
  SceneGraph scene = scene_of_one_take();
  const int hips = add_chain(scene, "hips", -1, 12, true, false);
  place_chain(scene, hips, 12, {0, 0.2, 0});
  const int jaw = add_chain(scene, "jaw", hips + 11, 2, true, false);
  place_chain(scene, jaw, 2, {0, 0, 0.05});
  scene.takes.clear();
  add_take(scene, "talk", {jaw});
  add_take(scene, "walk", numbers_from(hips, 12));
  add_take(scene, "wave", numbers_from(hips, 8));
  const auto choice_of = [&](std::vector<double> lengths) {
    for (std::size_t i = 0; i < 3; ++i) scene.takes[i].end = lengths[i];
    scene.motion = std::make_unique<EndKeys>(lengths);
    return value_of(choose_motion(scene, "", "", false, "a.fbx"));
  };
  EXPECT_EQ(choice_of({10, 5, 3}).take, 1);
  EXPECT_THAT(choice_of({10, 5, 3}).longer, ElementsAre("talk"));
  // Of takes that move the body, the longest one; of equally long ones, the first.
  EXPECT_EQ(choice_of({10, 5, 6}).take, 2);
  EXPECT_EQ(choice_of({5, 5, 5}).take, 1);
  EXPECT_THAT(choice_of({5, 5, 5}).longer, IsEmpty());
}

TEST(SceneSkeletonTest, NamesSkeletonsIfTheRequestedOneIsMissing) {
  SceneGraph scene = scene_of_one_take();
  add_chain(scene, "hips", -1, 12, true, true);
  scene.motion = std::make_unique<EndKeys>(std::vector<double>{1.0});
  const auto missing = choose_motion(scene, "", "Foo", false, "a.fbx");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(missing.error().message, HasSubstr("found hips"));
}

// A torso of 12 joints and two legs below a node that is not a joint.
SceneGraph scene_with_dummy_hips(bool moves, double leg_distance) {
  SceneGraph scene = scene_of_one_take();
  const int armature = add_chain(scene, "armature", -1, 1, false, false);
  const int hips = add_chain(scene, "hips", armature, 1, false, moves);
  place_chain(scene, add_chain(scene, "spine", hips, 12, true, true), 12, {0, 0.1, 0});
  for (const double side : {-1.0, 1.0}) {
    const int leg = add_chain(scene, "leg", hips, 4, true, true);
    place_chain(scene, leg, 4, {0, -0.4, 0});
    place_chain(scene, leg, 1, {side * leg_distance, 0, 0});
  }
  return scene;
}

TEST(SceneSkeletonTest, HipsMayBeADummy) {
  const SceneGraph scene = scene_with_dummy_hips(true, 0.1);
  for (const char* root : {"", "hips"}) {
    const auto chosen = value_of(choose_skeleton(scene, 0, root, "a.fbx"));
    EXPECT_EQ(scene.nodes[static_cast<std::size_t>(chosen.joints.front())].name, "hips");
    EXPECT_EQ(chosen.joints.size(), 21U);
  }
}

// An armature that stands still, or whose other roots are controls of the feet.
TEST(SceneSkeletonTest, ArmaturesAreNotHips) {
  for (const bool moves : {false, true}) {
    const SceneGraph scene = scene_with_dummy_hips(moves, moves ? 0.9 : 0.1);
    const auto chosen = value_of(choose_skeleton(scene, 0, "", "a.fbx"));
    EXPECT_EQ(chosen.joints.size(), 12U);
  }
}

TEST(SceneSkeletonTest, DropsAStillCopyOfTheMovingBody) {
  const auto kept_of = [](const Eigen::Vector3d& place, bool moves) {
    SceneGraph scene = scene_of_one_take();
    const int rig = add_chain(scene, "rig", -1, 1, true, true);
    const int still = add_chain(scene, "DEF-hips", rig, 12, true, moves);
    place_chain(scene, still, 12, {0, 0.1, 0});
    const int moving = add_chain(scene, "ORG-hips", rig, 12, true, true);
    place_chain(scene, moving, 12, {0, 0.1, 0});
    place_chain(scene, moving, 1, place);
    auto skeleton = value_of(choose_skeleton(scene, 0, "", "a.fbx"));
    const std::size_t dropped = drop_still_copies(scene, 0, skeleton);
    EXPECT_EQ(skeleton.joints.size() + dropped, 25U);
    EXPECT_EQ(dropped == 0 ? still : moving, skeleton.joints[1]);
    return skeleton.joints.size();
  };
  EXPECT_EQ(kept_of({0, 0.1, 0}, false), 13U);
  // Limbs at another place, such as an arm that is held still, and joints that move.
  EXPECT_EQ(kept_of({0.5, 0.1, 0}, false), 25U);
  EXPECT_EQ(kept_of({0, 0.1, 0}, true), 25U);
}

}  // namespace
}  // namespace retarget
