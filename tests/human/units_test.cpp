#include "human/units.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

TEST(GuessUnit, KnowsThePersonsHipHeightInEachUnit) {
  for (const double metres : {0.76, 0.9, 1.1}) {
    EXPECT_EQ(guess_unit(metres)->name, "m");
    EXPECT_EQ(guess_unit(metres * 10)->name, "dm");
    EXPECT_EQ(guess_unit(metres * 100)->name, "cm");
    EXPECT_EQ(guess_unit(metres * 1000)->name, "mm");
    EXPECT_EQ(guess_unit(metres / 0.0254)->name, "inch");
    EXPECT_EQ(guess_unit(metres / 0.056444)->name, "CMU unit");
  }
}

TEST(GuessUnit, KnowsNothingInBetween) {
  for (const double height : {0.0, 0.3, 3.0, 200.0, 5000.0, -90.0}) {
    EXPECT_FALSE(guess_unit(height)) << height;
  }
}

}  // namespace
}  // namespace retarget
