// Standing heights, contact phases and clearances of feet with closed-form paths.

#include "solve/fit/foot_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "fit/moving_feet.h"
#include "human/gait/standing_heights.h"
#include "support/angles.h"

namespace retarget {
namespace {

TEST(FootPlan, FindsStandingHeights) {
  const StandingHeights found = find_standing_heights(make_feet(3.0, 30.0, step), {});
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.ankle, kStandingAnkle, 1e-12);
  EXPECT_NEAR(found.toe, kStandingToe, 1e-12);
}

TEST(FootPlan, LyingFeetAreNotStanding) {
  SourceFeet feet = make_feet(3.0, 30.0, [](double) { return FootPlace{}; });
  // For half of the time the foot lies flat on its back, lower than when standing.
  for (std::size_t frame = 45; frame < feet.feet.size(); ++frame) {
    feet.feet[frame].ankle.z() = feet.feet[frame].toe.z() = -0.02;
  }
  const StandingHeights found = find_standing_heights(feet, {});
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.ankle, kStandingAnkle, 1e-12);
  EXPECT_NEAR(found.toe, kStandingToe, 1e-12);
}

TEST(FootPlan, ShortDipsDoNotDefineTheFloor) {
  // Stands for ten seconds, and sinks by 18 cm after a flip.
  const auto feet = make_feet(12.0, 30.0, [](double t) {
    const bool sunk = t > 10.5 && t < 11.1;
    return FootPlace{0.0, sunk ? -0.18 : t > 10.0 && t <= 10.5 ? 0.6 : 0.0};
  });
  const StandingHeights found = find_standing_heights(feet, {});
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.ankle, kStandingAnkle, 1e-12);
  EXPECT_NEAR(found.toe, kStandingToe, 1e-12);
}

// Stands for ten seconds in which the root sinks and rises again at these times.
SourceFeet feet_with_dips(const std::vector<double>& times, double seconds) {
  return make_feet(10.0, 30.0, [&](double t) {
    double height = 0.0;
    for (const double begin : times) {
      const double part = (t - begin) / seconds;
      if (part > 0.0 && part < 1.0) height -= 0.12 * std::pow(std::sin(kPi * part), 2.0);
    }
    return FootPlace{0.0, height};
  });
}

TEST(FootPlan, DipsOfTheRootDoNotDefineTheFloor) {
  for (const auto& times : std::vector<std::vector<double>>{{5.0}, {3.0, 7.0}, {2.0, 5.0, 8.0}}) {
    for (const double seconds : {0.5, 0.8}) {
      const StandingHeights found = find_standing_heights(feet_with_dips(times, seconds), {});
      EXPECT_TRUE(found.found) << times.size() << " " << seconds;
      EXPECT_NEAR(found.ankle, kStandingAnkle, 0.01);
      EXPECT_NEAR(found.toe, kStandingToe, 0.01);
    }
  }
}

TEST(FootPlan, ALostRootDoesNotDefineTheFloor) {
  // The foot swings while the root is lost.
  const auto lost = [](double t) { return t > 5.0 && t < 5.4; };
  const auto lost_feet = make_feet(10.0, 30.0, [&](double t) {
    return FootPlace{lost(t) ? t : 0.0, lost(t) ? -0.9 : 0.0};
  });
  EXPECT_NEAR(find_standing_heights(lost_feet, {}).toe, kStandingToe, 1e-12);
  // The person stands while the root is lost.
  const auto standing_feet = make_feet(10.0, 30.0, [&](double t) {
    return FootPlace{0.0, t > 5.0 && t < 5.3 ? -0.9 : 0.0};
  });
  EXPECT_NEAR(find_standing_heights(standing_feet, {}).toe, kStandingToe, 1e-12);
  // A jump off a box, to the floor and up again, is slower.
  const auto jumping_feet = make_feet(10.0, 30.0, [](double t) {
    const double away = std::abs(t - 5.1);
    return FootPlace{away < 0.3 ? t : 0.0, -std::clamp(1.5 - 5.0 * away, 0.0, 0.5)};
  });
  EXPECT_LT(find_standing_heights(jumping_feet, {}).toe, kStandingToe - 0.3);
}

TEST(FootPlan, ShortStaysOnTheFloorAreNoDips) {
  // Twice from a box to the floor.
  const auto stays = make_feet(10.0, 30.0, [](double t) {
    const bool down = (t >= 3.0 && t < 3.3) || (t >= 6.0 && t < 6.3);
    return FootPlace{0.0, down ? 0.0 : 0.2};
  });
  EXPECT_NEAR(find_standing_heights(stays, {}).toe, kStandingToe, 0.01);
  // The clip begins when the foot leaves the floor.
  const auto steps_up = make_feet(5.0, 30.0, [](double t) {
    return FootPlace{0.0, std::min(0.2, 0.5 * t)};
  });
  EXPECT_LT(find_standing_heights(steps_up, {}).toe, kStandingToe + 0.06);
}

TEST(FootPlan, ReboundsFromAStepAreOnTheFloor) {
  // Twice: a fall from a step of 0.2 m, 0.15 s on the floor, and a jump back.
  const auto height = [](double t) {
    const double off = std::abs(t) - 0.075;
    return off < 0.0 ? 0.0 : std::min(0.2, 2.4 * off);
  };
  const auto rebounds = make_feet(10.0, 30.0, [&](double t) {
    return FootPlace{0.0, std::min(height(t - 3.0), height(t - 6.0))};
  });
  EXPECT_NEAR(find_standing_heights(rebounds, {}).toe, kStandingToe, 0.02);
}

TEST(FootPlan, TheUpperFootOfALyingBodyDoesNotStand) {
  // The lower foot is flat on its side; the upper one rests on it.
  SourceFeet feet = make_feet(3.0, 30.0, [](double) { return FootPlace{0.0, 0.12}; });
  SourceFeet lying;
  lying.foot_count = 2;
  lying.frame_time = feet.frame_time;
  for (SourceFoot foot : feet.feet) {
    foot.sole_up = 0.0;
    lying.feet.push_back(foot);
    foot.ankle.z() = foot.toe.z() = 0.03;
    lying.feet.push_back(foot);
  }
  EXPECT_NEAR(find_standing_heights(lying, {}).toe, 0.03, 1e-12);
}

TEST(FootPlan, FloorIsTheLevelSteppedDownTo) {
  struct Case {
    double up, down, height;  // seconds on a box, on the floor; metres
  };
  for (const Case& c :
       {Case{5.0, 2.0, 0.3}, {20.0, 1.7, 0.6}, {12.0, 1.2, 0.2}, {20.0, 0.6, 0.6}}) {
    const auto feet = make_feet(c.up + c.down, 30.0, [&](double t) {
      return FootPlace{0.0, t < c.up ? c.height : 0.0};
    });
    EXPECT_LT(find_standing_heights(feet, {}).toe, kStandingToe + 0.01) << c.up << " " << c.down;
  }
}

TEST(FootPlan, LowestStepOfStairsIsTheFloor) {
  // Fifteen steps, each with contact for less than a tenth of the time.
  const auto feet = make_feet(22.5, 30.0, [](double t) {
    return FootPlace{0.0, 0.15 * std::floor(t / 1.5)};
  });
  EXPECT_NEAR(find_standing_heights(feet, {}).toe, kStandingToe, 1e-12);
}

TEST(FootPlan, GuessesTheFloorIfNoFootStands) {
  const auto feet = make_feet(2.0, 30.0, [](double t) { return FootPlace{2.0 * t, 0.0}; });
  const StandingHeights found = find_standing_heights(feet, {});
  EXPECT_FALSE(found.found);
  EXPECT_NEAR(found.toe, kStandingToe, 1e-12);
  EXPECT_GT(found.ankle, found.toe);
}

TEST(FootPlan, FindsPhasesOfAStep) {
  const FootPlan plan = plan_of(make_feet(3.0, 30.0, step));
  ASSERT_EQ(plan.phases.size(), 4U);
  for (const int end : {kHeelEnd, kToeEnd}) {
    const PlantedPhase& first = plan.phases[static_cast<std::size_t>(2 * end)];
    const PlantedPhase& second = plan.phases[static_cast<std::size_t>(2 * end + 1)];
    EXPECT_EQ(first.foot_end, end);
    // Speeds cover two frames: the last frame at rest already has the speed of the next step.
    EXPECT_EQ(first.begin, 0);
    EXPECT_EQ(first.end, 30);
    EXPECT_EQ(second.begin, 46);
    EXPECT_EQ(second.end, 91);
  }
  EXPECT_TRUE(plan.ends_of(10)[0].level);
  EXPECT_EQ(plan.ends_of(35)[0].phase, -1);
}

TEST(FootPlan, PhasesAreIndependentOfTheFrameRate) {
  for (const double fps : {24.0, 25.0, 60.0, 120.0, 240.0}) {
    const FootPlan plan = plan_of(make_feet(3.0, fps, step));
    ASSERT_EQ(plan.phases.size(), 4U) << fps;
    EXPECT_NEAR(plan.phases[0].end / fps, 1.0, 2.0 / fps) << fps;
    EXPECT_NEAR(plan.phases[1].begin / fps, 1.5, 2.0 / fps) << fps;
  }
}

TEST(FootPlan, PlantedFootIsReleasedAtTheReleaseSpeed) {
  // 0.2 m/s is between the start speed and the release speed of a contact.
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

TEST(FootPlan, DropsShortContacts) {
  // At rest for less than a tenth of a second.
  const auto feet = make_feet(3.0, 30.0, [](double t) {
    return t < 1.0 ? FootPlace{} : FootPlace{t < 1.5 ? t - 1.0 : std::max(0.5, t - 1.1), 0.0};
  });
  const FootPlan plan = plan_of(feet);
  ASSERT_EQ(plan.phases.size(), 2U);
  EXPECT_EQ(plan.phases[0].begin, 0);
}

TEST(FootPlan, FootOnItsSideIsPlantedOnlyHorizontally) {
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

TEST(FootPlan, FootNearTheFloorLiesUnlessItIsUpright) {
  SourceFeet feet = make_feet(3.0, 30.0, [](double t) {
    return FootPlace{0.0, t < 2.0 ? 0.0 : 0.3};
  });
  for (std::size_t frame = 30; frame < feet.feet.size(); ++frame) feet.feet[frame].up = 0.05;
  const FootPlan plan = plan_of(feet);
  EXPECT_EQ(plan.lying_of(10)[0], 0.0);
  EXPECT_EQ(plan.lying_of(45)[0], 1.0);
  EXPECT_EQ(plan.lying_of(75)[0], 0.0);
}

// A knee that rests from frame 20 to 60, while its joint moves by `slide` along x; before and after
// it moves by 2 cm per frame.
SourceFeet feet_with_knee(double slide) {
  SourceFeet feet = make_feet(3.0, 30.0, [](double) { return FootPlace{}; });
  feet.has_support[0] = true;
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    const double way = std::clamp((frame - 20) / 39.0, 0.0, 1.0);
    const double x = slide * way + 0.02 * std::min(0, frame - 20) + 0.02 * std::max(0, frame - 59);
    feet.supports.emplace_back(x, 0.0, 0.05);
    for (std::size_t i = 1; i < kSupportBones.size(); ++i) {
      feet.supports.emplace_back(0.0, 0.0, 0.9);
    }
  }
  return feet;
}

FootPlan plan_of_knee(const SourceFeet& feet, double scale) {
  FootPlan plan = plan_of(feet);
  ContactPlan contacts;
  contacts.bodies[0] = {{20, 60, 0.0}};
  SupportBody knee;
  plan_supports(feet, contacts, std::span(&knee, 1), feet.frame_count(), scale, plan);
  return plan;
}

TEST(FootPlan, RestingKneeIsHeldInPlace) {
  const FootPlan plan = plan_of_knee(feet_with_knee(0.03), 0.5);
  const PlantedPhase& phase = plan.phases.back();
  EXPECT_EQ(phase.support, 0);
  EXPECT_EQ(phase.begin, 17);
  EXPECT_EQ(phase.first(), 20);
  EXPECT_EQ(phase.last(), 60);
  EXPECT_EQ(phase.end, 63);
  for (int frame = 20; frame < 60; ++frame) {
    EXPECT_EQ(plan.supports_of(frame)[0].slide.norm(), 0.0);
    EXPECT_EQ(plan.supports_of(frame)[0].share, 1.0);
  }
}

TEST(FootPlan, HoldsOfAKneeFadeOutsideItsContactAlongTheSource) {
  const FootPlan plan = plan_of_knee(feet_with_knee(0.03), 0.5);
  double before = 1.0;
  for (int away = 1; away <= 3; ++away) {
    const SupportGoal& early = plan.supports_of(20 - away)[0];
    const SupportGoal& late = plan.supports_of(59 + away)[0];
    EXPECT_NEAR(early.slide.x(), -0.5 * 0.02 * away, 1e-12);
    EXPECT_NEAR(late.slide.x(), 0.5 * 0.02 * away, 1e-12);
    EXPECT_LT(early.share, before);
    EXPECT_EQ(early.share, late.share);
    before = early.share;
  }
  EXPECT_EQ(plan.supports_of(16)[0].phase, -1);
  EXPECT_EQ(plan.supports_of(63)[0].phase, -1);
}

// Stands for a second, then moves at 1 m/s along x.
SourceFeet leaving_feet(double fps) {
  return make_feet(1.5, fps, [](double t) { return FootPlace{std::max(0.0, t - 1.0), 0.0}; });
}

TEST(FootPlan, HoldsOfFeetFadeWithinAThirtiethOfASecond) {
  constexpr double kScale = 0.5;
  for (const double fps : {60.0, 120.0}) {
    const SourceFeet feet = leaving_feet(fps);
    FootPlan plan = plan_of(feet, kScale);
    const int last = plan.phases[0].last() - 1, after = static_cast<int>(fps / 30.0) - 1;
    ease_contacts(feet, std::array{0}, kScale, nullptr, plan);
    EXPECT_EQ(plan.phases[0].last(), last + 1) << fps;
    EXPECT_EQ(plan.phases[0].end, last + 1 + after) << fps;
    double hold = plan.ends_of(last)[0].hold;
    EXPECT_NEAR(hold, std::sqrt(fps / 30.0), 1e-12);
    for (int away = 1; away <= after; ++away) {
      const FootEndGoal& goal = plan.ends_of(last + away)[0];
      EXPECT_EQ(goal.phase, -1);
      EXPECT_EQ(goal.near_phase, 0);
      EXPECT_LT(goal.hold, hold);
      const Eigen::Vector3d moved = feet.at(last + away, 0).ankle - feet.at(last, 0).ankle;
      EXPECT_NEAR(goal.slide.x(), kScale * moved.x(), 1e-12);
      hold = goal.hold;
    }
    EXPECT_LT(hold, 0.11) << fps;
    EXPECT_EQ(plan.ends_of(last + after + 1)[0].near_phase, -1) << fps;
    EXPECT_FALSE(plan.plants(last + 1)) << fps;
  }
}

TEST(FootPlan, HoldsOfFeetDoNotFadeAtThirtyFramesPerSecond) {
  for (const double fps : {24.0, 30.0, 30.0003}) {
    const SourceFeet feet = leaving_feet(fps);
    FootPlan plan = plan_of(feet);
    ease_contacts(feet, std::array{0}, 1.0, nullptr, plan);
    EXPECT_EQ(plan.phases[0].before + plan.phases[0].after, 0) << fps;
    for (const FootEndGoal& goal : plan.ends) {
      EXPECT_EQ(goal.near_phase, -1) << fps;
      EXPECT_EQ(goal.hold, 1.0) << fps;
    }
  }
}

TEST(FootPlan, FeetBesideARestingKneeKeepTheirWeight) {
  SourceFeet feet = feet_with_knee(0.03);
  FootPlan plan = plan_of_knee(feet, 0.5);
  feet.frame_time = 1.0 / 120.0;
  ease_contacts(feet, std::array{0}, 0.5, nullptr, plan);
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    EXPECT_EQ(plan.ends_of(frame)[0].hold, 1.0) << frame;
  }
}

TEST(FootPlan, FeetKeepTheirWeightBesidePartsThatASceneCarries) {
  struct Contact {
    bool at_rest = true;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double share = 1.0;
    double hold = 2.0;  // Of the foot.
  };
  const std::array contacts = {
      Contact{.hold = 1.0},
      Contact{.at_rest = false},
      Contact{.normal = Eigen::Vector3d::UnitX()},   // A wall.
      Contact{.normal = -Eigen::Vector3d::UnitZ()},  // The underside of a table.
      Contact{.share = 0.9},                         // The part approaches the surface.
  };
  const SourceFeet feet = leaving_feet(120.0);
  for (const Contact& contact : contacts) {
    FitScene scene;
    scene.world.fixed = {static_cast<char>(contact.at_rest)};
    scene.goals.resize(static_cast<std::size_t>(feet.frame_count()));
    for (SceneGoal& goal : scene.goals) {
      goal.normal = contact.normal;
      goal.share = contact.share;
    }
    for (int frame = 0; frame <= feet.frame_count(); ++frame) {
      scene.first_goal.push_back(static_cast<std::uint32_t>(frame));
    }
    FootPlan plan = plan_of(feet);
    ease_contacts(feet, std::array{0}, 1.0, &scene, plan);
    EXPECT_NEAR(plan.ends_of(0)[0].hold, contact.hold, 1e-12) << &contact - contacts.data();
  }
}

TEST(FootPlan, SlidingKneeSlidesAsFarAsItsSource) {
  const FootPlan plan = plan_of_knee(feet_with_knee(0.4), 0.5);
  EXPECT_NEAR(plan.supports_of(59)[0].slide.x(), 0.5 * (0.4 - kRestingRadius), 1e-12);
  int visited = 0;
  plan.for_each_planted(59, [&](int index, const Eigen::Vector2d& slide) {
    if (plan.phases[static_cast<std::size_t>(index)].support < 0) return;
    EXPECT_EQ(slide, plan.supports_of(59)[0].slide);
    ++visited;
  });
  EXPECT_EQ(visited, 1);
}

TEST(FootPlan, ScalesClearanceAndWeightsFlight) {
  const FootPlan plan = plan_of(make_feet(3.0, 30.0, step), 0.5);
  // In the middle of the step, a quarter of a metre up.
  const FootEndGoal& middle = plan.ends_of(38)[0];
  EXPECT_NEAR(middle.clearance, 0.5 * step(38.0 / 30.0).height, 1e-12);
  EXPECT_DOUBLE_EQ(middle.importance, 5.0);
  EXPECT_EQ(plan.ends_of(10)[0].importance, 1.0);
}

TEST(FootPlan, StandingOnABoxIsNotFlight) {
  const auto feet = make_feet(4.0, 30.0, [](double t) {
    return FootPlace{0.0, t < 2.0 ? 0.0 : 0.3};
  });
  EXPECT_EQ(plan_of(feet).ends_of(100)[0].importance, 1.0);
}

// Stands for a second; then the foot is 0.3 m higher and half a metre ahead, and stands there.
FootPlace step_up(double t) {
  const double way = std::clamp(2.0 * (t - 1.0), 0.0, 1.0);
  return {0.5 * way, 0.3 * way};
}

TEST(FootPlan, StillRaisedFootIsSupported) {
  for (const double fps : {30.0, 120.0}) {
    const FootPlan plan = plan_of(make_feet(3.0, fps, step_up), 0.5);
    ASSERT_EQ(plan.phases.size(), 4U) << fps;
    const int late = static_cast<int>(2.5 * fps);
    for (const std::size_t end : {kHeelEnd, kToeEnd}) {
      const PlantedPhase& raised = plan.phases[2 * end + 1];
      EXPECT_NEAR(raised.begin / fps, 1.5, 2.0 / fps);
      EXPECT_EQ(raised.end, static_cast<int>(3.0 * fps) + 1);
      const FootEndGoal& goal = plan.ends_of(late)[end];
      EXPECT_TRUE(goal.level);
      EXPECT_NEAR(goal.support, 0.5 * 0.3, 1e-12);
      EXPECT_EQ(plan.ends_of(10)[end].support, 0.0);
    }
  }
}

TEST(FootPlan, CountsFramesOnRaisedSurfaces) {
  const SourceFeet feet = make_feet(3.0, 30.0, step_up);
  const RaisedFrames raised = raised_frames(plan_of(feet, 0.5), feet.frame_count());
  EXPECT_NEAR(raised.count, 45, 3);
  EXPECT_NEAR(raised.highest, 0.5 * 0.3, 1e-12);
  const SourceFeet low = make_feet(3.0, 30.0, step);
  EXPECT_EQ(raised_frames(plan_of(low), low.frame_count()).count, 0);
}

TEST(FootPlan, AFootOnABoxBesideOneOnTheFloorIsNotRaised) {
  SourceFeet feet = make_feet(3.0, 30.0, step_up);
  SourceFeet both = feet;
  both.foot_count = 2;
  both.feet.clear();
  for (const SourceFoot& foot : feet.feet) {
    both.feet.push_back(foot);
    both.feet.push_back(feet.feet.front());
  }
  FootPlan plan;
  const ContactOptions options = contact_options({});
  plan_feet(both, find_contacts(both, options), options, std::array{0, 1}, 1.0, {}, plan);
  EXPECT_EQ(raised_frames(plan, both.frame_count()).count, 0);
}

// A foot that lies down on a bed has the goals of one on the floor, at the height of the bed.
TEST(FootPlan, FeetOnABedLieAsOnTheFloor) {
  constexpr double kBed = 0.5;
  SourceFeet feet = make_feet(3.0, 30.0, [](double t) {
    return FootPlace{t < 1.0 ? 0.0 : 0.3 * std::min(1.0, t - 1.0), t < 1.0 ? 0.0 : 0.01};
  });
  for (std::size_t frame = 30; frame < feet.feet.size(); ++frame) feet.feet[frame].up = 0.0;
  const ContactOptions options = contact_options({});
  ContactPlan contacts = find_contacts(feet, options);
  FootPlan low, high;
  plan_feet(feet, contacts, options, std::array{0}, 1.0, {}, low);
  for (SourceFoot& foot : feet.feet) {
    foot.ankle.z() += kBed;
    foot.toe.z() += kBed;
  }
  for (EndContacts& end : contacts.ends[0]) {
    for (ContactPhase& phase : end.phases) phase.support += kBed;
  }
  const std::vector<double> ground(2 * feet.feet.size(), kBed);
  plan_feet(feet, contacts, options, std::array{0}, 1.0, ground, high);
  EXPECT_GT(*std::ranges::max_element(low.lying), 0.9);
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    EXPECT_NEAR(high.lying_of(frame)[0], low.lying_of(frame)[0], 1e-9) << frame;
    EXPECT_NEAR(high.upright_of(frame)[0], low.upright_of(frame)[0], 1e-9) << frame;
    for (std::size_t end : {kHeelEnd, kToeEnd}) {
      const FootEndGoal &on_bed = high.ends_of(frame)[end], &on_floor = low.ends_of(frame)[end];
      EXPECT_NEAR(on_bed.support, kBed, 1e-9) << frame;
      EXPECT_NEAR(on_bed.clearance - kBed, on_floor.clearance, 1e-9) << frame;
      EXPECT_NEAR(on_bed.importance, on_floor.importance, 1e-9) << frame;
    }
  }
}

TEST(FootPlan, FlatFootHasHeelAndToeAtTheSameHeight) {
  SourceFeet feet = make_feet(3.0, 30.0, step_up);
  for (SourceFoot& foot : feet.feet) {
    if (foot.ankle.z() > kStandingAnkle + 0.2) foot.toe.z() += 0.02;
  }
  const FootPlan plan = plan_of(feet);
  EXPECT_NEAR(plan.ends_of(75)[kHeelEnd].support, 0.31, 1e-12);
  EXPECT_EQ(plan.ends_of(75)[kHeelEnd].support, plan.ends_of(75)[kToeEnd].support);
}

TEST(FootPlan, ToeStaysOnTheStepWhileTheHeelLifts) {
  SourceFeet feet = make_feet(3.0, 30.0, step_up);
  for (std::size_t frame = 75; frame < feet.feet.size(); ++frame) {
    feet.feet[frame].ankle.z() += 0.5 * (static_cast<double>(frame) / 30.0 - 2.5);
  }
  const FootPlan plan = plan_of(feet);
  EXPECT_EQ(plan.ends_of(85)[kHeelEnd].phase, -1);
  EXPECT_GE(plan.ends_of(85)[kToeEnd].phase, 0);
  EXPECT_NEAR(plan.ends_of(85)[kToeEnd].support, 0.3, 1e-12);
}

TEST(FootPlan, FeetInTheAirAreNotInContact) {
  // A foot that lingers at the top of a slow kick, and one that is held there but sways.
  const auto kick = make_feet(3.0, 30.0, [](double t) {
    return FootPlace{0.0, t < 1.0 ? 0.0 : 0.4 * std::max(0.0, 1.0 - std::abs(t - 2.0))};
  });
  const auto sways = make_feet(3.0, 30.0, [](double t) {
    const double up = std::clamp(t - 1.0, 0.0, 0.5);
    return FootPlace{0.05 * std::sin(2.5 * (t - 1.0)) * up / 0.5, up};
  });
  for (const SourceFeet& feet : {kick, sways}) {
    const FootPlan plan = plan_of(feet);
    for (int frame = 40; frame < 88; ++frame) EXPECT_EQ(plan.ends_of(frame)[kHeelEnd].support, 0.0);
  }
}

TEST(FootPlan, FlightRequiresFreeFall) {
  // Feet rise and fall while the hips stay in place, or rise by g T^2 / 8.
  SourceFeet feet = make_feet(3.0, 30.0, step);
  feet.hips.assign(feet.feet.size(), 0.2);
  EXPECT_EQ(plan_of(feet).ends_of(38)[kToeEnd].importance, 1.0);
  for (std::size_t frame = 30; frame < 46; ++frame) {
    const double t = static_cast<double>(frame) / 30.0 - 1.25;
    feet.hips[frame] += 0.5 * 9.81 * (0.0625 - t * t);
  }
  EXPECT_NEAR(plan_of(feet).ends_of(38)[kToeEnd].importance, 5.0, 1e-9);
}

TEST(FootPlan, TuckedFootInFlightUsesItsLowerEnd) {
  // A jump with the foot pointing down: the ankle is a foot length above the toe.
  SourceFeet feet = make_feet(3.0, 30.0, step);
  for (std::size_t frame = 34; frame < 42; ++frame) {
    feet.feet[frame].ankle.z() += 0.12;
    feet.feet[frame].up = 0.05;
  }
  const FootPlan plan = plan_of(feet);
  EXPECT_DOUBLE_EQ(plan.ends_of(38)[kToeEnd].importance, 5.0);
  EXPECT_NEAR(plan.ends_of(38)[kHeelEnd].importance, 0.0, 1e-12);
  EXPECT_EQ(plan.upright_of(38)[0], 1.0);
}

}  // namespace
}  // namespace retarget
