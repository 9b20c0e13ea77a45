#include "formats/scene/key_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace retarget {
namespace {

std::vector<double> float_times(double fps, const std::vector<int>& frames, double begin = 0.0) {
  std::vector<double> result;
  // As floats, like in glTF.
  for (const int frame : frames) result.push_back(static_cast<float>(begin + frame / fps));
  return result;
}

std::vector<int> first_frames(int count) {
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) frames.push_back(i);
  return frames;
}

// The rate and the number of the last frame: `30 fps to 4`; `none`.
std::string grid_text(const std::vector<double>& times) {
  const auto grid = grid_of_keys(times);
  if (!grid) return "none";
  return to_text(grid->rate) + " fps to " + std::to_string(grid->frames.back());
}

TEST(KeyRateTest, FindsTheRateOfEvenKeys) {
  EXPECT_EQ(grid_text(float_times(30, {0, 1, 2, 3, 4})), "30 fps to 4");
  EXPECT_NEAR(grid_of_keys(float_times(119.88, {3, 0, 1, 2, 1000}, 1.5))->fps, 119.88, 1e-2);
}

TEST(KeyRateTest, ToleratesOmittedKeys) {
  EXPECT_EQ(grid_text(float_times(60, {0, 7, 8, 30, 90})), "60 fps to 90");
  EXPECT_EQ(grid_text(float_times(60, {0, 7, 8, 30, 90}, 600.0)), "60 fps to 90");
}

// The gap between two floats far from zero is inaccurate; the mean of all gaps is not.
TEST(KeyRateTest, FindsTheRateOfLongAndLateClipsInSinglePrecision) {
  for (const int fps : {24, 25, 30, 50, 60, 90, 100, 120, 240}) {
    for (const double begin : {0.0, 10.0, 600.0, 3000.0}) {
      for (const int seconds : {1, 70, 300}) {
        const int last = fps * seconds;
        EXPECT_EQ(grid_text(float_times(fps, first_frames(last + 1), begin)),
                  std::to_string(fps) + " fps to " + std::to_string(last))
            << begin;
      }
    }
  }
  EXPECT_EQ(grid_of_keys(float_times(30000.0 / 1001.0, first_frames(9000)))->rate,
            (FrameRate{30000, 1001}));
}

TEST(KeyRateTest, FindsTheRateOfTimesThatAreRoundedToMilliseconds) {
  for (const int fps : {24, 25, 30, 60, 90, 120, 240}) {
    for (const int last : {3, 50, 3000}) {
      std::vector<double> times;
      for (const int frame : first_frames(last + 1)) {
        times.push_back(1e-3 * std::round(1e3 * frame / fps));
      }
      EXPECT_EQ(grid_text(times), std::to_string(fps) + " fps to " + std::to_string(last));
    }
  }
}

// The literal frame time of many BVH files.
TEST(KeyRateTest, CountsTheFramesOfARoundedFrameTime) {
  EXPECT_EQ(grid_text(float_times(1.0 / 0.033333, first_frames(10000))), "30 fps to 9999");
}

// The error of a sum in single precision grows with time.
TEST(KeyRateTest, FindsTheFramesOfTimesThatAreSums) {
  for (const int fps : {30, 60, 120}) {
    std::vector<double> times;
    float time = 0.0F;
    for (int i = 0; i < 20000; ++i, time += 1.0F / static_cast<float>(fps)) times.push_back(time);
    EXPECT_EQ(grid_text(times), std::to_string(fps) + " fps to 19999");
  }
}

TEST(KeyRateTest, FindsNoneForManualKeys) {
  EXPECT_EQ(grid_text({0.0, 0.033, 0.08, 0.3}), "none");
  EXPECT_EQ(grid_text({0.0, 0.033}), "none");
  EXPECT_EQ(grid_text({}), "none");
  EXPECT_EQ(grid_text({NAN, NAN, INFINITY, 0.0}), "none");
  std::vector<double> uneven;
  for (int i = 0; i < 300; ++i) uneven.push_back(i / 30.0 + (i % 7 == 3 ? 0.01 : 0.0));
  EXPECT_EQ(grid_text(uneven), "none");
  // Even keys that are too slow for frames.
  EXPECT_EQ(grid_text({0.0, 0.5, 1.0, 2.0}), "2 fps to 4");
}

TEST(KeyRateTest, InterpolatesTheTimesOfOmittedKeys) {
  const auto grid = grid_of_keys({1.0, 1.1, 1.2, 1.4}).value();
  EXPECT_DOUBLE_EQ(grid.time_of(1), 1.1);
  EXPECT_DOUBLE_EQ(grid.time_of(3), 1.3);
  EXPECT_DOUBLE_EQ(grid.time_of(6), 1.6);
}

}  // namespace
}  // namespace retarget
