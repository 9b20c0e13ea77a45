#include "retarget/clip.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

TEST(FrameRate, SnapsFrameTimesToWholeRates) {
  EXPECT_EQ(frame_rate_from_frame_time(0.033333), (FrameRate{30, 1}));
  EXPECT_EQ(frame_rate_from_frame_time(0.0333), (FrameRate{10000, 333}));  // 1e-3 off: another rate
  EXPECT_EQ(frame_rate_from_frame_time(.0083333), (FrameRate{120, 1}));
  EXPECT_EQ(frame_rate_from_frame_time(0.016667), (FrameRate{60, 1}));
  EXPECT_EQ(frame_rate_from_frame_time(1.0), (FrameRate{1, 1}));
}

TEST(FrameRate, DistinguishesFilmRatesFromWholeRates) {
  EXPECT_EQ(frame_rate_from_frame_time(0.0417083750417), (FrameRate{2997, 125}));
  EXPECT_EQ(frame_rate_from_fps(23.976), (FrameRate{2997, 125}));
  EXPECT_EQ(frame_rate_from_fps(0.5), (FrameRate{1, 2}));
}

TEST(FrameRate, HandlesExtremeValues) {
  for (const double value : {1e-300, 1e-12, 3e8, 1e300}) {
    const FrameRate rate = frame_rate_from_fps(value);
    EXPECT_GT(rate.frames, 0) << value;
    EXPECT_GT(rate.seconds, 0) << value;
    EXPECT_GT(frame_rate_from_frame_time(value).frames, 0) << value;
  }
}

TEST(FrameRate, FrameTimesDoNotDrift) {
  const FrameRate rate = frame_rate_from_frame_time(0.033333);
  EXPECT_DOUBLE_EQ(rate.time_of(31779), 31779 / 30.0);
}

TEST(FrameRate, FormatsAsText) {
  EXPECT_EQ(to_text(FrameRate{30, 1}), "30");
  EXPECT_EQ(to_text(FrameRate{2997, 125}), "23.976");
}

}  // namespace
}  // namespace retarget
