#include "formats/scene/clip_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace retarget {
namespace {

std::vector<double> times(double fps, const std::vector<int>& frames, double begin = 0.0) {
  std::vector<double> result;
  // As floats, like in glTF.
  for (const int frame : frames) result.push_back(static_cast<float>(begin + frame / fps));
  return result;
}

TEST(KeyRateTest, FindsTheRateOfEvenKeys) {
  EXPECT_NEAR(*rate_of_keys(times(30, {0, 1, 2, 3, 4})), 30.0, 1e-3);
  EXPECT_NEAR(*rate_of_keys(times(119.88, {3, 0, 1, 2, 1000}, 1.5)), 119.88, 1e-2);
}

TEST(KeyRateTest, ToleratesOmittedKeys) {
  EXPECT_NEAR(*rate_of_keys(times(60, {0, 7, 8, 30, 90})), 60.0, 1e-3);
}

TEST(KeyRateTest, FindsNoneForManualKeys) {
  EXPECT_FALSE(rate_of_keys({0.0, 0.5, 1.0, 2.0}));
  EXPECT_FALSE(rate_of_keys({0.0, 0.033, 0.08, 0.3}));
  EXPECT_FALSE(rate_of_keys({0.0, 0.033}));
  EXPECT_FALSE(rate_of_keys({}));
  EXPECT_FALSE(rate_of_keys({NAN, NAN, INFINITY, 0.0}));
}

}  // namespace
}  // namespace retarget
