#include "batch/split.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace retarget {
namespace {

using ::testing::HasSubstr;

TEST(Split, ReadsRatioAndSeed) {
  const Split split = parse_split("0.8:seed").value();
  EXPECT_EQ(split.ratio, 0.8);
  EXPECT_EQ(split.seed, "seed");
  EXPECT_EQ(parse_split("0.5").value().seed, "");
  for (const char* text : {"", "1", "0", "-0.5:1", "nan:1", "0.9x", ":1", "1.5:2"}) {
    EXPECT_FALSE(parse_split(text)) << text;
  }
}

TEST(Split, ReadsThreeShares) {
  const Split split = parse_split("0.8,0.1,0.1:seed").value();
  EXPECT_EQ(split.ratio, 0.8);
  EXPECT_EQ(split.test, 0.1);
  EXPECT_EQ(split.seed, "seed");
  EXPECT_EQ(parse_split("0.7,0.2,0.1").value().test, 0.1);
  EXPECT_EQ(parse_split("0.333,0.333,0.334").value().seed, "");
  // Two shares form a ratio.
  EXPECT_EQ(parse_split("0.8,0.2").value().ratio, 0.8);
  EXPECT_EQ(parse_split("0.8,0.2").value().test, 0.0);
}

TEST(Split, RejectsSharesThatDoNotAddUpToOne) {
  for (const char* text : {"0.8,0.1,0.2", "0.8,0.1,0.05:1", "0.9,0.2", "80,10,10", "0.9,0.1,0",
                           "0.4,0.3,0.2,0.1", "0.8,,0.2", "0.8,0.1,", "1.1,-0.2,0.1", ","}) {
    const auto split = parse_split(text);
    ASSERT_FALSE(split) << text;
    EXPECT_THAT(split.error().message, HasSubstr(text));
    EXPECT_THAT(split.error().hint, HasSubstr("0.8,0.1,0.1")) << text;
  }
  EXPECT_THAT(parse_split("0.8,0.1,0.2").error().message, HasSubstr("add up to 1.1"));
}

TEST(GroupOf, FindsTheSubjectInNames) {
  const std::vector<std::pair<std::string, std::string>> subjects = {
      {"walk1_subject5.bvh", "subject 5"},
      {"dance/dance2_subject05_mirrored.bvh", "subject 5"},
      {"sub3_largebox_003.pt", "subject 3"},
      {"BMLmovi/Subject_11_F_MoSh/Subject_11_F_10_poses.npz", "subject 11"},
      {"07_01.bvh", "subject 7"},
      {"CMU/07/07_12_poses.npz", "subject 7"},
      {"cmu_daz_03_03.bvh", "subject 3"},
      {"KIT/3/walking_slow08_poses.npz", "KIT/3"},
      {"BMLrub/rub001/0000_treadmill_norm_poses.npz", "BMLrub/rub001"},
      {"ACCAD/Female1General_c3d/A1 - Stand_poses.npz", "ACCAD/female1"},
      {"ACCAD/Female1Walking_c3d/B1_stageii.npz", "ACCAD/female1"},
      {"GRAB/s1/airplane_fly_1.npz", "GRAB/s1"},
      {"GRAB/s1/day1/airplane_fly_1.npz", "GRAB/s1"},
      {"KIT/3/morning/walk_poses.npz", "KIT/3"},
      {"s1/01/w.bvh", "s1"},
      {"s1/02/w.bvh", "s1"},
      {"s2/01/x.bvh", "s2"},
      {"sub 3/2/x.bvh", "sub 3"},
      {"female1/3/x_poses.npz", "female1"},
      {"x/3/01/w.bvh", "x/3"}};
  for (const auto& [name, key] : subjects) {
    const ClipGroup group = group_of(name);
    EXPECT_EQ(group.key, key) << name;
    EXPECT_TRUE(group.is_subject) << name;
  }
}

TEST(GroupOf, IsTheFileWithoutASubject) {
  for (const char* name : {"walk.bvh", "a/run_fast.bvh", "2024/take.bvh", "subjective.bvh",
                           "clip_100.bvh", "robots3/x.bvh"}) {
    EXPECT_FALSE(group_of(name).is_subject) << name;
  }
  EXPECT_EQ(group_of("a/walk.bvh").key, "a/walk");
  // Mirror images of one motion.
  EXPECT_EQ(group_of("joints/M000123.npy").key, group_of("joints/000123.npy").key);
  EXPECT_EQ(group_of("a/walk_mirrored.bvh").key, "a/walk");
  EXPECT_NE(group_of("b/walk.bvh").key, "a/walk");
}

std::vector<std::string> persons(int count, int clips) {
  std::vector<std::string> groups;
  for (int i = 0; i < count; ++i)
    groups.insert(groups.end(), static_cast<std::size_t>(clips), "subject " + std::to_string(i));
  return groups;
}

void expect_whole_groups(const std::vector<std::string>& groups,
                         const std::vector<SplitSide>& sides) {
  std::map<std::string, SplitSide> side;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto [at, is_new] = side.emplace(groups[i], sides[i]);
    EXPECT_EQ(at->second, sides[i]) << groups[i];
  }
}

TEST(SplitClips, KeepsGroupsTogetherAndTheRatio) {
  const std::vector<std::string> groups = persons(100, 7);
  const auto sides = split_clips(groups, {0.9, "1"}).value();
  expect_whole_groups(groups, sides);
  EXPECT_EQ(std::ranges::count(sides, SplitSide::kTrain), 630);
  EXPECT_EQ(std::ranges::count(sides, SplitSide::kValidation), 70);
}

TEST(SplitClips, KeepsThreeShares) {
  const std::vector<std::string> groups = persons(100, 7);
  const auto sides = split_clips(groups, {0.7, "1", 0.1}).value();
  expect_whole_groups(groups, sides);
  EXPECT_EQ(std::ranges::count(sides, SplitSide::kTrain), 490);
  EXPECT_EQ(std::ranges::count(sides, SplitSide::kValidation), 140);
  EXPECT_EQ(std::ranges::count(sides, SplitSide::kTest), 70);
}

TEST(SplitClips, TestShareDoesNotChangeTheValidationClips) {
  const std::vector<std::string> groups = persons(50, 3);
  const auto two = split_clips(groups, {0.8, "7"}).value();
  const auto three = split_clips(groups, {0.6, "7", 0.2}).value();
  for (std::size_t i = 0; i < groups.size(); ++i) {
    EXPECT_EQ(two[i] == SplitSide::kValidation, three[i] == SplitSide::kValidation) << i;
  }
}

TEST(SplitClips, DependsOnlyOnSeedAndGroups) {
  const std::vector<std::string> groups = persons(40, 3);
  std::vector<std::string> reversed(groups.rbegin(), groups.rend());
  auto one = split_clips(groups, {0.8, "a"}).value();
  auto other = split_clips(reversed, {0.8, "a"}).value();
  std::reverse(other.begin(), other.end());
  EXPECT_EQ(one, other);
  EXPECT_NE(one, split_clips(groups, {0.8, "b"}).value());
}

TEST(SplitClips, FillsBothSidesWithTwoGroups) {
  for (const double ratio : {0.01, 0.5, 0.99}) {
    const auto sides = split_clips(persons(2, 5), {ratio, ""}).value();
    EXPECT_EQ(std::ranges::count(sides, SplitSide::kTrain), 5) << ratio;
  }
  for (const double test : {0.0, 0.05}) {
    const auto alone = split_clips(persons(1, 5), {0.9, "", test}).value();
    EXPECT_EQ(std::ranges::count(alone, SplitSide::kTrain), 5);
  }
  EXPECT_TRUE(split_clips({}, {0.9, ""}).value().empty());
}

TEST(SplitClips, FillsThreeSidesWithThreeGroups) {
  for (const double ratio : {0.02, 0.34, 0.97}) {
    for (const double share : {0.3, 0.5, 0.9}) {
      const double test = share * (1.0 - ratio);
      for (const int persons_there : {3, 4, 9}) {
        const auto sides = split_clips(persons(persons_there, 5), {ratio, "", test}).value();
        for (const SplitSide side : {SplitSide::kTrain, SplitSide::kValidation, SplitSide::kTest}) {
          EXPECT_GE(std::ranges::count(sides, side), 5) << ratio << " " << test;
        }
      }
    }
  }
}

TEST(Split, ErrorShowsTheForm) {
  EXPECT_THAT(parse_split("2:1").error().message, HasSubstr("RATIO:SEED"));
}

}  // namespace
}  // namespace retarget
