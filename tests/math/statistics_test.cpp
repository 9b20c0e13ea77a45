#include "retarget/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace retarget {
namespace {

TEST(Statistics, PercentilesInterpolateBetweenRanks) {
  // numpy.percentile([15, 20, 35, 40, 50], p)
  const std::vector<double> values = {50, 15, 40, 20, 35};
  EXPECT_DOUBLE_EQ(percentile(values, 0), 15);
  EXPECT_DOUBLE_EQ(percentile(values, 2), 15.4);
  EXPECT_DOUBLE_EQ(percentile(values, 40), 29);
  EXPECT_DOUBLE_EQ(percentile(values, 95), 48);
  EXPECT_DOUBLE_EQ(percentile(values, 100), 50);
  EXPECT_DOUBLE_EQ(percentile({7}, 99), 7);
}

TEST(Statistics, MedianIsTheMiddleValue) {
  EXPECT_DOUBLE_EQ(median({3, 1, 2}), 2);
  EXPECT_DOUBLE_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_DOUBLE_EQ(median({9}), 9);
  EXPECT_DOUBLE_EQ(mean({1, 2, 6}), 3);
}

// NaN has no order and must not be sorted.
TEST(Statistics, EmptyInputAndNaNGiveNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(percentile({}, 95)));
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(mean({})));
  for (std::size_t at = 0; at < 40; ++at) {
    std::vector<double> values(40, 1.0);
    for (std::size_t i = 0; i < values.size(); i += 3) values[i] = static_cast<double>(i);
    values[at] = nan;
    EXPECT_TRUE(std::isnan(percentile(values, 95))) << at;
    EXPECT_TRUE(std::isnan(median(values))) << at;
  }
  EXPECT_TRUE(std::isnan(percentile(std::vector<double>(40, nan), 95)));
}

TEST(Statistics, InfiniteValuesAreOrdered) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(percentile({inf, 1, 2}, 100), inf);
  EXPECT_EQ(percentile({inf, 1, inf}, 90), inf);
  EXPECT_EQ(percentile({inf, 1, -inf}, 50), 1);
  EXPECT_EQ(median({inf, 1, 2}), 2);
}

}  // namespace
}  // namespace retarget
