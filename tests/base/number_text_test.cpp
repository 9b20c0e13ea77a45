#include "retarget/text.h"

#include <gtest/gtest.h>

#include <limits>

namespace retarget {
namespace {

TEST(NumberText, HasNoTrailingZerosAndNoExponent) {
  EXPECT_EQ(number_text(9.97, 2), "9.97");
  EXPECT_EQ(number_text(30.0, 2), "30");
  EXPECT_EQ(number_text(100.0, 0), "100");
  EXPECT_EQ(number_text(0.1 + 0.2, 6), "0.3");
  EXPECT_EQ(number_text(1e-9, 3), "0");
  EXPECT_EQ(number_text(-1e-9, 3), "0");
  EXPECT_EQ(number_text(-2.5, 3), "-2.5");
  EXPECT_EQ(number_text(std::numeric_limits<double>::max(), 6).size(), 309U);
}

}  // namespace
}  // namespace retarget
