// Standing heights, contact phases and clearances of feet whose paths are known in closed form.

#include "refine/foot_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace retarget {
namespace {

constexpr double kAnkleHeight = 0.09, kToeHeight = 0.02;  // standing heights, metres

// height and way of a foot at a time; both its ends go alike
struct FootPlace {
  double x = 0.0, height = 0.0;
};
using FootPath = std::function<FootPlace(double seconds)>;

// one foot that goes along x
SourceFeet make_feet(double seconds, double fps, const FootPath& path) {
  SourceFeet feet;
  feet.foot_count = 1;
  feet.frame_time = 1.0 / fps;
  const int frames = static_cast<int>(std::lround(seconds * fps)) + 1;
  for (int frame = 0; frame < frames; ++frame) {
    const FootPlace place = path(frame / fps);
    SourceFoot foot;
    foot.ankle = {place.x, 0.0, kAnkleHeight + place.height};
    foot.toe = {place.x + 0.14, 0.0, kToeHeight + place.height};
    feet.feet.push_back(foot);
  }
  return feet;
}

// stands for a second, goes up at 1 m/s, and down, and stands half a metre ahead
FootPlace step(double t) {
  const double up = std::max(0.0, 0.25 - std::abs(t - 1.25));
  return {0.5 * std::min(1.0, std::max(0.0, 2.0 * (t - 1.0))), up};
}

FootPlan plan_of(const SourceFeet& feet, double scale = 1.0) {
  const FitOptions options;
  return plan_feet(feet, find_standing_heights(feet, options), scale, options);
}

TEST(FootPlan, FindsTheHeightsAtWhichFeetStand) {
  const StandingHeights found = find_standing_heights(make_feet(3.0, 30.0, step), {});
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.ankle, kAnkleHeight, 1e-12);
  EXPECT_NEAR(found.toe, kToeHeight, 1e-12);
}

TEST(FootPlan, FeetThatLieDoNotCountAsStanding) {
  SourceFeet feet = make_feet(3.0, 30.0, [](double) { return FootPlace{}; });
  // for half of the time the foot lies flat on its back, lower than it stands
  for (std::size_t frame = 45; frame < feet.feet.size(); ++frame) {
    feet.feet[frame].ankle.z() = feet.feet[frame].toe.z() = -0.02;
  }
  const StandingHeights found = find_standing_heights(feet, {});
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.ankle, kAnkleHeight, 1e-12);
  EXPECT_NEAR(found.toe, kToeHeight, 1e-12);
}

TEST(FootPlan, AFootThatNeverStandsGivesAGuess) {
  const auto feet = make_feet(2.0, 30.0, [](double t) { return FootPlace{2.0 * t, 0.0}; });
  const StandingHeights found = find_standing_heights(feet, {});
  EXPECT_FALSE(found.found);
  EXPECT_NEAR(found.toe, kToeHeight, 1e-12);
  EXPECT_GT(found.ankle, found.toe);
}

TEST(FootPlan, PhasesAreThoseOfTheStep) {
  const FootPlan plan = plan_of(make_feet(3.0, 30.0, step));
  ASSERT_EQ(plan.phases.size(), 4U);
  for (const int end : {kHeel, kToe}) {
    const PlantedPhase& first = plan.phases[static_cast<std::size_t>(2 * end)];
    const PlantedPhase& second = plan.phases[static_cast<std::size_t>(2 * end + 1)];
    EXPECT_EQ(first.foot_end, end);
    // speeds are those over two frames: the last one at rest already has that of the next step
    EXPECT_EQ(first.begin, 0);
    EXPECT_EQ(first.end, 30);
    EXPECT_EQ(second.begin, 46);
    EXPECT_EQ(second.end, 91);
  }
  EXPECT_TRUE(plan.ends_of(10)[0].level);
  EXPECT_EQ(plan.ends_of(35)[0].phase, -1);
}

TEST(FootPlan, PhasesAreTheSameTimesAtEveryFrameRate) {
  for (const double fps : {24.0, 25.0, 60.0, 120.0, 240.0}) {
    const FootPlan plan = plan_of(make_feet(3.0, fps, step));
    ASSERT_EQ(plan.phases.size(), 4U) << fps;
    EXPECT_NEAR(plan.phases[0].end / fps, 1.0, 2.0 / fps) << fps;
    EXPECT_NEAR(plan.phases[1].begin / fps, 1.5, 2.0 / fps) << fps;
  }
}

TEST(FootPlan, ASlowFootStaysPlantedUntilTheReleaseSpeed) {
  // 0.2 m/s lies between the speed that plants and the one that releases
  const auto later = make_feet(3.0, 30.0, [](double t) {
    return FootPlace{t < 1.0 ? 0.0 : 0.2 * (t - 1.0), 0.0};
  });
  ASSERT_EQ(plan_of(later).phases.size(), 2U);
  EXPECT_EQ(plan_of(later).phases[0].end, 91);
  const auto sooner = make_feet(3.0, 30.0, [](double t) {
    return FootPlace{t < 2.0 ? 0.2 * t : 0.4, 0.0};
  });
  ASSERT_EQ(plan_of(sooner).phases.size(), 2U);
  EXPECT_EQ(plan_of(sooner).phases[0].begin, 60);
}

TEST(FootPlan, ShortContactsAreNone) {
  // at rest for less than a tenth of a second
  const auto feet = make_feet(3.0, 30.0, [](double t) {
    return t < 1.0 ? FootPlace{} : FootPlace{t < 1.5 ? t - 1.0 : std::max(0.5, t - 1.1), 0.0};
  });
  const FootPlan plan = plan_of(feet);
  ASSERT_EQ(plan.phases.size(), 2U);
  EXPECT_EQ(plan.phases[0].begin, 0);
}

TEST(FootPlan, AFootOnItsSideIsPinnedButNotInHeight) {
  SourceFeet feet = make_feet(2.0, 30.0, [](double) { return FootPlace{}; });
  for (std::size_t frame = 30; frame < feet.feet.size(); ++frame) {
    feet.feet[frame].up = 0.05;
    feet.feet[frame].side = 0.99;
  }
  const FootPlan plan = plan_of(feet);
  EXPECT_TRUE(plan.ends_of(10)[0].level);
  EXPECT_GE(plan.ends_of(50)[0].phase, 0);
  EXPECT_FALSE(plan.ends_of(50)[0].level);
  EXPECT_FALSE(plan.ends_of(50)[1].level);
  EXPECT_EQ(plan.upright_of(10)[0], 1.0);
  EXPECT_EQ(plan.upright_of(50)[0], 0.0);
}

TEST(FootPlan, ClearanceIsScaledAndCountsMoreInFlight) {
  const FootPlan plan = plan_of(make_feet(3.0, 30.0, step), 0.5);
  // in the middle of the step, a quarter of a metre up
  const FootEndGoal& middle = plan.ends_of(38)[0];
  EXPECT_NEAR(middle.clearance, 0.5 * step(38.0 / 30.0).height, 1e-12);
  EXPECT_EQ(middle.importance, 4.0);
  EXPECT_EQ(plan.ends_of(10)[0].importance, 1.0);
}

TEST(FootPlan, WhatStandsOnABoxDoesNotFly) {
  const auto feet = make_feet(4.0, 30.0, [](double t) {
    return FootPlace{0.0, t < 2.0 ? 0.0 : 0.3};
  });
  EXPECT_EQ(plan_of(feet).ends_of(100)[0].importance, 1.0);
}

}  // namespace
}  // namespace retarget
