#include "batch/manifests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace retarget {
namespace {

using ::testing::ElementsAre;

std::vector<BatchInput> hundred_inputs() {
  std::vector<BatchInput> inputs;
  for (int i = 0; i < 100; ++i) {
    const std::string name = std::to_string(i) + ".bvh";
    inputs.push_back({"in/" + name, name, static_cast<std::uint64_t>(7919 * i % 1000), 0});
  }
  return inputs;
}

TEST(ShardText, ParsesShards) {
  EXPECT_EQ(parse_shard("2/8")->index, 2);
  EXPECT_EQ(parse_shard("8/8")->count, 8);
  for (const char* text :
       {"", "0/8", "9/8", "1", "1/", "/8", "1/8x", "a/b", "-1/8", "1/0", "1 /8"}) {
    const auto shard = parse_shard(text);
    ASSERT_FALSE(shard) << text;
    EXPECT_EQ(shard.error().kind, ErrorKind::kUsage);
  }
}

TEST(Shards, PartitionInputsEvenly) {
  for (const int count : {1, 3, 8, 200}) {
    std::set<std::string> seen;
    std::size_t all = 0;
    for (int index = 1; index <= count; ++index) {
      std::uint64_t bytes = 0;
      for (const BatchInput& input : take_shard(hundred_inputs(), {index, count})) {
        seen.insert(input.relative);
        ++all;
        bytes += input.bytes;
      }
      if (count == 8) {
        EXPECT_NEAR(static_cast<double>(bytes), 99 * 500 / 8.0, 1000.0);
      }
    }
    EXPECT_EQ(all, 100U);
    EXPECT_EQ(seen.size(), 100U);
  }
}

TEST(Shards, AreIndependentOfInputOrder) {
  auto inputs = hundred_inputs();
  const auto one = take_shard(inputs, {2, 3});
  std::ranges::reverse(inputs);
  const auto other = take_shard(inputs, {2, 3});
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].path, other[i].path);
}

TEST(LongestFirst, OrdersTiesByName) {
  std::vector<BatchInput> inputs = {{"b", "b", 1}, {"c", "c", 5}, {"a", "a", 1}};
  sort_longest_first(inputs);
  std::vector<std::string> names;
  for (const BatchInput& input : inputs) names.push_back(input.relative);
  EXPECT_THAT(names, ElementsAre("c", "a", "b"));
}

}  // namespace
}  // namespace retarget
