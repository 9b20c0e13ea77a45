#include "retarget/base/suggest.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace retarget {
namespace {

const std::vector<std::string> kRobots = {"unitree_g1", "unitree_h1", "booster_t1", "fourier_n1"};

TEST(NearestName, FindsSlipsOfTheKeyboard) {
  EXPECT_EQ(nearest_name("unitre_g1", kRobots), "unitree_g1");
  EXPECT_EQ(nearest_name("untiree_g1", kRobots), "unitree_g1");
  EXPECT_EQ(nearest_name("Unitree_H1", kRobots), "unitree_h1");
}

TEST(NearestName, KeepsSilentWhenNothingIsNear) {
  EXPECT_EQ(nearest_name("atlas", kRobots), "");
  EXPECT_EQ(nearest_name("", kRobots), "");
  EXPECT_EQ(did_you_mean("atlas", kRobots), "");
}

TEST(ListNames, CountsTheRest) {
  EXPECT_EQ(list_names(kRobots, 2), "unitree_g1, unitree_h1 and 2 more");
  EXPECT_EQ(list_names({}, 2), "");
}

}  // namespace
}  // namespace retarget
