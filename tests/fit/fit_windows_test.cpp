// The division of a clip into windows, and the dependencies of each window.

#include "solve/fit/fit_windows.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

FitClip clip_with_phases(int frames, std::vector<PlantedPhase> phases) {
  FitClip clip;
  clip.frame_count = frames;
  clip.feet.phases = std::move(phases);
  return clip;
}

TEST(FitWindows, CoverEveryFrameOnceWithSeamsOverBorders) {
  const FitWindows plan = plan_windows(clip_with_phases(4918, {}), FitOptions{});
  ASSERT_EQ(plan.windows.size(), 8U);
  ASSERT_EQ(plan.seams.size(), 7U);
  int end = 0;
  for (const FitWindow& window : plan.windows) {
    EXPECT_EQ(window.begin, end);
    EXPECT_FALSE(window.fixed_ends);
    end = window.end;
  }
  EXPECT_EQ(end, 4918);
  for (std::size_t i = 0; i < plan.seams.size(); ++i) {
    EXPECT_EQ((plan.seams[i].begin + plan.seams[i].end) / 2, plan.windows[i].end);
    EXPECT_TRUE(plan.seams[i].fixed_ends);
    // A seam reads no frames of other seams, nor beyond the two windows that it depends on.
    const int reach = plan.seams[i].context + 1;
    EXPECT_GE(plan.seams[i].begin - reach, plan.windows[i].begin);
    EXPECT_LE(plan.seams[i].end + reach, plan.windows[i + 1].end);
    if (i > 0) {
      EXPECT_GE(plan.seams[i].begin - reach, plan.seams[i - 1].end + reach);
    }
  }
}

TEST(FitWindows, WaitForContactsAcrossTheirBorders) {
  // One foot end always stands: contacts of 1 s follow each other.
  std::vector<PlantedPhase> phases;
  for (int begin = 0; begin + 60 <= 1800; begin += 30) {
    phases.push_back({begin, begin + 60, (begin / 30) % 2, kHeelEnd});
  }
  const FitWindows plan = plan_windows(clip_with_phases(1800, phases), FitOptions{});
  ASSERT_EQ(plan.windows.size(), 3U);
  for (std::size_t i = 0; i < plan.windows.size(); ++i) {
    EXPECT_GE(plan.frames_needed[i], plan.windows[i].end);
    EXPECT_LT(plan.frames_needed[i], plan.windows[i].end + 60);
    for (const PlantedPhase& phase : phases) {
      const bool seen = phase.begin < plan.windows[i].end;
      EXPECT_TRUE(!seen || phase.end <= plan.frames_needed[i]);
    }
  }
  EXPECT_EQ(plan.frames_needed.back(), 1800);
}

TEST(FitWindows, ShortClipHasOneWindow) {
  for (const int frames : {0, 1, 2, 300}) {
    const FitWindows plan = plan_windows(clip_with_phases(frames, {}), FitOptions{});
    ASSERT_EQ(plan.windows.size(), 1U);
    EXPECT_EQ(plan.windows.front().end, frames);
    EXPECT_TRUE(plan.seams.empty());
  }
}

}  // namespace
}  // namespace retarget
