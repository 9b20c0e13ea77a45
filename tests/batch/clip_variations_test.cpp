// Variations of clips: their names, their changes, and what these depend on.

#include "batch/input_variants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "retarget/text.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<BatchInput> varied(const SolveOptions& options, int seed = 1) {
  return *with_variations({{"/in/a/climb.bvh", "a/climb.bvh"}, {"/in/walk.bvh", "walk.bvh"}}, 3,
                          seed, options);
}

SolveOptions in_scene() {
  SolveOptions options;
  options.scene = "room.json";
  return options;
}

TEST(ClipVariations, FollowTheirOriginals) {
  const auto inputs = varied(in_scene());
  ASSERT_EQ(inputs.size(), 8u);
  EXPECT_FALSE(inputs[1].variant.is_derived());
  EXPECT_EQ(inputs[2].relative, "a/climb_v1.bvh");
  EXPECT_EQ(inputs[7].relative, "walk_v3.bvh");
  EXPECT_EQ(inputs[7].path, "/in/walk.bvh");
  EXPECT_EQ(inputs[7].variant.source, "walk.bvh");
  EXPECT_EQ(inputs[7].variant.original(), "walk.bvh");
}

TEST(ClipVariations, DependOnSeedNameAndNumberOnly) {
  const auto first = varied(in_scene()), again = varied(in_scene()), other = varied(in_scene(), 2);
  std::set<std::string> changes;
  for (std::size_t i = 2; i < first.size(); ++i) {
    EXPECT_EQ(first[i].variant, again[i].variant);
    EXPECT_NE(first[i].variant.changes, other[i].variant.changes);
    changes.insert(first[i].variant.changes);
  }
  EXPECT_EQ(changes.size(), 6u);
}

TEST(ClipVariations, ChangeTheScene) {
  SolveOptions options = in_scene();
  apply_changes(varied(options)[2].variant.changes, options);
  ASSERT_THAT(options.terrain_scale, StartsWith("z="));
  const double scale = *parse_number<double>(options.terrain_scale.substr(2));
  EXPECT_GE(scale, 0.8);
  EXPECT_LE(scale, 1.2);

  options = in_scene();
  options.object_tracks = {"box.csv"};
  const std::string changes = varied(options)[2].variant.changes;
  EXPECT_THAT(changes, HasSubstr(",0 object-scale="));
  apply_changes(changes, options);
  EXPECT_FALSE(options.object_shift.empty());
  EXPECT_NE(options.object_scale, 1.0);
  EXPECT_TRUE(options.terrain_scale.empty());
}

TEST(ClipVariations, ChangeTerrainWithinItsLimits) {
  SolveOptions options;
  options.terrain = "stairs:0.5x0.3x4";
  for (const BatchInput& input : varied(options)) {
    if (!input.variant.is_varied()) continue;
    SolveOptions changed = options;
    apply_changes(input.variant.changes, changed);
    EXPECT_THAT(changed.terrain, StartsWith("stairs:0."));
    EXPECT_TRUE(changed.terrain.ends_with("x4")) << changed.terrain;
    EXPECT_LE(*parse_number<double>(changed.terrain.substr(7, 5)), 0.5);
  }
  options.terrain = "slope:30";
  SolveOptions changed = options;
  apply_changes(varied(options)[2].variant.changes, changed);
  EXPECT_LE(*parse_number<double>(changed.terrain.substr(6)), 30.0);
}

TEST(ClipVariations, RequireAScene) {
  const auto refused = with_variations({{"/in/walk.bvh", "walk.bvh"}}, 1, 0, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
}

TEST(ClipVariations, UnknownChangesAreIgnored) {
  SolveOptions options;
  apply_changes("", options);
  apply_changes("=  x= terrain", options);
  EXPECT_EQ(options.terrain, "");
  EXPECT_EQ(options.object_scale, 1.0);
}

}  // namespace
}  // namespace retarget
