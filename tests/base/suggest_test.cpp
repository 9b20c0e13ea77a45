#include "retarget/text.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace retarget {
namespace {

const std::vector<std::string> kRobots = {"unitree_g1", "unitree_h1", "booster_t1", "fourier_n1"};

TEST(NearestName, FindsTypos) {
  EXPECT_EQ(nearest_name("unitre_g1", kRobots), "unitree_g1");
  EXPECT_EQ(nearest_name("untiree_g1", kRobots), "unitree_g1");
  EXPECT_EQ(nearest_name("Unitree_H1", kRobots), "unitree_h1");
}

TEST(NearestName, SuggestsNothingIfNothingIsNear) {
  EXPECT_EQ(nearest_name("atlas", kRobots), "");
  EXPECT_EQ(nearest_name("", kRobots), "");
  EXPECT_EQ(did_you_mean("atlas", kRobots), "");
}

// A file may contain a name of several megabytes.
TEST(NearestName, SkipsVeryLongNames) {
  const std::vector<std::string> candidates = {std::string(100, 'a')};
  EXPECT_EQ(nearest_name(std::string(99, 'a'), candidates), candidates[0]);
  EXPECT_EQ(nearest_name(std::string(101, 'a'), candidates), "");
}

TEST(NearestName, IsIndependentOfOrder) {
  const std::vector<std::string> names = {"left_hip", "left_hip_roll", "left_hip_yaw", "left_knee"};
  const std::vector<std::string> reversed(names.rbegin(), names.rend());
  for (const auto& [name, nearest] :
       std::vector<std::pair<std::string, std::string>>{{"left_hip_rol", "left_hip_roll"},
                                                        {"left_hpi", "left_hip"},
                                                        {"Left_Knee", "left_knee"},
                                                        {"eft_hip_yaws", "left_hip_yaw"},
                                                        {"right_hip", ""},
                                                        {"left_hip_wya", "left_hip_yaw"}}) {
    EXPECT_EQ(nearest_name(name, names), nearest);
    EXPECT_EQ(nearest_name(name, reversed), nearest);
  }
}

TEST(ListNames, CountsOmittedNames) {
  EXPECT_EQ(list_names(kRobots, 2), "unitree_g1, unitree_h1 and 2 more");
  EXPECT_EQ(list_names({}, 2), "");
}

}  // namespace
}  // namespace retarget
