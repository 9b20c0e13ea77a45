#include "batch/split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "batch/motion_signature.h"

namespace retarget {
namespace {

ManifestEntry clip(const std::string& name, const std::string& hash) {
  ManifestEntry entry;
  entry.relative = name;
  entry.robot = "g1";
  entry.done = true;
  entry.input.hash = hash;
  return entry;
}

// Ten seconds of swinging limbs; each number has a different pace.
MotionSignature swinging(int pace) {
  MotionSignature of;
  of.seconds = 10.0;
  for (int i = 0; i < 50; ++i) {
    for (std::size_t j = 0; j < kSignatureNumbers; ++j) {
      const int at = (i * pace + static_cast<int>(j) * 5) % 40;
      of.samples.push_back(static_cast<std::int8_t>((at < 20 ? at : 40 - at) * 4 - 40));
    }
  }
  return of;
}

MotionSignature motionless() {
  MotionSignature of = swinging(1);
  for (std::size_t i = 0; i < of.samples.size(); ++i)
    of.samples[i] = of.samples[i % kSignatureNumbers];
  return of;
}

std::vector<std::string> keys_of(const std::vector<ManifestEntry>& entries) {
  std::vector<const ManifestEntry*> pointers;
  for (const ManifestEntry& entry : entries) pointers.push_back(&entry);
  return split_groups(pointers).keys;
}

TEST(SplitGroups, AreTheNamesIfAllInputsDiffer) {
  const std::vector<std::string> keys =
      keys_of({clip("a/walk.bvh", "1"), clip("walk1_subject5.bvh", "2"),
               clip("run1_subject5.bvh", "3"), clip("a/walk_mirrored.bvh", "4")});
  EXPECT_EQ(keys, (std::vector<std::string>{"a/walk", "subject 5", "subject 5", "a/walk"}));
}

TEST(SplitGroups, JoinClipsOfTheSameInput) {
  const auto keys = keys_of({clip("copy.bvh", "1"), clip("a/walk.bvh", "1"), clip("run.bvh", "2")});
  EXPECT_EQ(keys, (std::vector<std::string>{"a/walk", "a/walk", "run"}));
}

TEST(SplitGroups, DoNotJoinInputsOfUnknownHash) {
  EXPECT_EQ(keys_of({clip("a.bvh", ""), clip("b.bvh", "")}), (std::vector<std::string>{"a", "b"}));
}

TEST(SplitGroups, ACopyJoinsTwoPersons) {
  const auto keys = keys_of({clip("walk1_subject1.bvh", "1"), clip("run1_subject1.bvh", "2"),
                             clip("walk1_subject2.bvh", "3"), clip("copy_subject2.bvh", "2"),
                             clip("walk1_subject3.bvh", "4")});
  EXPECT_EQ(keys, (std::vector<std::string>{"subject 1", "subject 1", "subject 1", "subject 1",
                                            "subject 3"}));
}

TEST(SplitGroups, JoinPartsAndMirrorImagesOfCopies) {
  ManifestEntry part = clip("b/one.bvh", "1");
  part.variant = {"b/take.bvh", "f0:f10", ""};
  ManifestEntry image = clip("c_mirrored.bvh", "1");
  image.variant = {"c.bvh", "", "c.bvh"};
  ManifestEntry image_of_part = clip("b/two_mirrored.bvh", "1");
  image_of_part.variant = {"b/take.bvh", "f10:f20", "b/two.bvh"};
  const auto keys = keys_of({part, image, image_of_part, clip("d.bvh", "2")});
  EXPECT_EQ(keys, (std::vector<std::string>{"b/take", "b/take", "b/take", "d"}));
}

TEST(SplitGroups, DoNotDependOnTheOrder) {
  std::vector<ManifestEntry> entries = {clip("e.bvh", "3"), clip("d.bvh", "2"), clip("c.bvh", "2"),
                                        clip("b.bvh", "1"), clip("a.bvh", "1")};
  entries[1].signature = signature_bytes(swinging(3));
  entries[3].signature = signature_bytes(mirrored(swinging(3)));
  const auto keys = keys_of(entries);
  EXPECT_EQ(keys, (std::vector<std::string>{"e", "a", "a", "a", "a"}));
  do {
    auto of_order = keys_of(entries);
    std::ranges::sort(of_order);
    EXPECT_EQ(of_order, (std::vector<std::string>{"a", "a", "a", "a", "e"}));
  } while (std::ranges::next_permutation(entries, {}, &ManifestEntry::relative).found);
}

ManifestEntry listed(const std::string& name, const std::string& file) {
  ManifestEntry entry = clip(name, file);
  entry.input.file = file;
  return entry;
}

TEST(SplitGroups, TakeThePersonFromTheFoldersOfAFile) {
  EXPECT_EQ(keys_of({listed("walk_poses.npz", "amass/KIT/3/walk_poses.npz"),
                     listed("run_poses.npz", "./amass/KIT/3/run_poses.npz"),
                     listed("sit_poses.npz", "amass/KIT/4/sit_poses.npz")}),
            (std::vector<std::string>{"3", "3", "4"}));
  EXPECT_EQ(keys_of({listed("a.npz", "GRAB/s1/day1/a.npz"), listed("b.npz", "GRAB/s1/day2/b.npz"),
                     listed("c.npz", "GRAB/s2/day1/c.npz")}),
            (std::vector<std::string>{"s1", "s1", "s2"}));
}

TEST(SplitGroups, TakeNoPersonFromAFolderAboveAllFiles) {
  EXPECT_EQ(keys_of({listed("a_poses.npz", "/mnt/1/a_poses.npz"),
                     listed("b_poses.npz", "/mnt/1/b_poses.npz")}),
            (std::vector<std::string>{"a_poses", "b_poses"}));
}

// About a degree from swinging(3), like a copy that is trimmed off the grid of the signature.
MotionSignature swinging_nearly() {
  MotionSignature of = swinging(3);
  for (std::size_t i = 0; i < of.samples.size(); i += 2) of.samples[i] += 2;
  return of;
}

TEST(SplitGroups, JoinNearFilesUnlessTheyAreOfTwoPersons) {
  ASSERT_GT(signature_distance(swinging(3), swinging_nearly()), 0.5);
  ASSERT_LT(signature_distance(swinging(3), swinging_nearly()), 2.5);
  const auto keys = [](const std::string& a, const std::string& b) {
    std::vector<ManifestEntry> entries = {clip(a, "1"), clip(b, "2")};
    entries[0].signature = signature_bytes(swinging(3));
    entries[1].signature = signature_bytes(swinging_nearly());
    return keys_of(entries);
  };
  EXPECT_EQ(keys("a.bvh", "b.bvh"), (std::vector<std::string>{"a", "a"}));
  EXPECT_EQ(keys("walk_subject1.bvh", "b.bvh"), (std::vector<std::string>{"b", "b"}));
  EXPECT_EQ(keys("walk_subject1.bvh", "walk_subject2.bvh"),
            (std::vector<std::string>{"subject 1", "subject 2"}));
}

TEST(SplitGroups, JoinCopiesThatAreCutShorterStepByStep) {
  std::vector<ManifestEntry> entries = {clip("c.bvh", "1"), clip("a.bvh", "2"), clip("b.bvh", "3")};
  // The first and the last differ too much in length to be compared.
  for (std::size_t i = 0; i < entries.size(); ++i) {
    MotionSignature cut = swinging(3);
    cut.samples.resize(cut.samples.size() - 2 * i * kSignatureNumbers);
    cut.seconds -= 0.4 * static_cast<double>(i);
    entries[i].signature = signature_bytes(cut);
  }
  EXPECT_EQ(keys_of(entries), (std::vector<std::string>{"a", "a", "a"}));
}

TEST(SplitGroups, JoinMirroredFilesOfAnyName) {
  std::vector<ManifestEntry> entries = {clip("x.bvh", "1"), clip("y.bvh", "2"), clip("z.bvh", "3")};
  entries[0].signature = signature_bytes(mirrored(swinging(3)));
  entries[1].signature = signature_bytes(swinging(3));
  entries[2].signature = signature_bytes(swinging(7));
  EXPECT_EQ(keys_of(entries), (std::vector<std::string>{"x", "x", "z"}));
}

TEST(SplitGroups, DoNotJoinStandingClips) {
  std::vector<ManifestEntry> entries = {clip("tpose_subject1.bvh", "1"),
                                        clip("tpose_subject2.bvh", "2")};
  for (ManifestEntry& entry : entries) entry.signature = signature_bytes(motionless());
  EXPECT_EQ(keys_of(entries), (std::vector<std::string>{"subject 1", "subject 2"}));
}

TEST(SplitGroups, CountGroupsAndJoinedClips) {
  const std::vector<ManifestEntry> entries = {clip("walk1_subject1.bvh", "1"), clip("b.bvh", "1"),
                                              clip("c.bvh", "2"), clip("d.bvh", "3")};
  std::vector<const ManifestEntry*> pointers;
  for (const ManifestEntry& entry : entries) pointers.push_back(&entry);
  const SplitGroups groups = split_groups(pointers);
  EXPECT_EQ(groups.by_subject, 1U);
  EXPECT_EQ(groups.by_file, 2U);
  EXPECT_EQ(groups.joined, 1U);
}

}  // namespace
}  // namespace retarget
