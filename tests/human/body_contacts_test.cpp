// Contacts of knees, elbows, hands, seat and back of a human with the floor.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "human/gait/contact_plan.h"
#include "human/gait/standing_heights.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr StandingHeights kStanding{0.08, 0.02, true};
constexpr std::size_t kLeftKnee = 0, kLeftHand = 4, kSeat = 6;

// All joints far up except one, whose position is a function of time.
SourceFeet source_with(std::size_t support, int frames,
                       const std::function<Eigen::Vector3d(int)>& place, double fps = 30.0) {
  SourceFeet source;
  source.frame_time = 1.0 / fps;
  source.foot_count = 2;
  source.feet.resize(2 * static_cast<std::size_t>(frames));
  source.has_support.fill(true);
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
      source.supports.push_back(i == support ? place(frame) : Eigen::Vector3d(0.0, 0.0, 0.8));
    }
  }
  return source;
}

std::vector<ContactPhase> contacts(const SourceFeet& source, std::size_t support,
                                   double scale = 1.0) {
  BodyContacts all;
  find_body_contacts(source, kStanding, scale, {}, all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i != support) {
      EXPECT_THAT(all[i], IsEmpty()) << i;
    }
  }
  return all[support];
}

TEST(BodyContacts, LowAndStillKneeIsInContact) {
  const auto down_from_20_to_50 = [](int frame) {
    return Eigen::Vector3d(0.0, 0.0, frame >= 20 && frame < 50 ? 0.05 : 0.4);
  };
  // The part is fast while it falls and rises.
  EXPECT_THAT(contacts(source_with(kLeftKnee, 80, down_from_20_to_50), kLeftKnee),
              ElementsAre(ContactPhase{21, 49}));
}

TEST(BodyContacts, LowBackRestsOnlyWithLowShoulders) {
  constexpr std::size_t kBack = 7;
  static_assert(kSupportBones[kBack] == Bone::kSpine2);
  SourceFeet source = source_with(kBack, 30, [](int) { return Eigen::Vector3d(0.0, 0.0, 0.12); });
  EXPECT_THAT(contacts(source, kBack), ElementsAre(ContactPhase{0, 30}));
  source.has_upper.fill(true);
  const auto with_shoulders_at = [&](double left, double right) {
    source.uppers.clear();
    for (int frame = 0; frame < 30; ++frame) {
      for (const double height : {left, right, 0.3}) source.uppers.emplace_back(0.0, 0.0, height);
    }
    return contacts(source, kBack);
  };
  EXPECT_THAT(with_shoulders_at(0.1, 0.12), ElementsAre(ContactPhase{0, 30}));
  // On its side.
  EXPECT_THAT(with_shoulders_at(0.08, 0.34), ElementsAre(ContactPhase{0, 30}));
  // Propped up on an elbow.
  EXPECT_THAT(with_shoulders_at(0.23, 0.38), IsEmpty());
}

TEST(BodyContacts, UseTheHeightOfTheJoint) {
  const auto at = [](double height) {
    return [height](int) { return Eigen::Vector3d(0.0, 0.0, height); };
  };
  EXPECT_THAT(contacts(source_with(kLeftKnee, 30, at(0.14)), kLeftKnee), IsEmpty());
  EXPECT_THAT(contacts(source_with(kSeat, 30, at(0.14)), kSeat), ElementsAre(ContactPhase{0, 30}));
  // The height is halved for a body of half the size.
  EXPECT_THAT(contacts(source_with(kSeat, 30, at(0.14)), kSeat, 0.5), IsEmpty());
}

// Moves along x at a constant speed.
std::function<Eigen::Vector3d(int)> sliding(double speed, double height) {
  return [=](int frame) { return Eigen::Vector3d(speed * frame / 30.0, 0.0, height); };
}

TEST(BodyContacts, SlowSlideIsOneContact) {
  EXPECT_THAT(contacts(source_with(kLeftKnee, 60, sliding(0.1, 0.05)), kLeftKnee),
              ElementsAre(ContactPhase{0, 60}));
  EXPECT_THAT(contacts(source_with(kLeftKnee, 60, sliding(0.4, 0.05)), kLeftKnee), IsEmpty());
}

TEST(BodyContacts, HandThatCatchesAFallIsInContact) {
  // Fast down to the floor, five frames at 0.27 m/s, fast up.
  const auto catches = [](double lowest) {
    return [=](int frame) {
      const double away = std::max(0, std::abs(frame - 20) - 3);
      return Eigen::Vector3d(0.009 * frame, 0.0, lowest + 0.1 * away);
    };
  };
  EXPECT_THAT(contacts(source_with(kLeftHand, 40, catches(0.03)), kLeftHand), testing::SizeIs(1));
  EXPECT_THAT(contacts(source_with(kLeftHand, 40, catches(0.07)), kLeftHand), IsEmpty());
  EXPECT_THAT(contacts(source_with(kLeftKnee, 40, catches(0.03)), kLeftKnee), IsEmpty());
}

TEST(BodyContacts, CatchDoesNotExtendARestingHand) {
  // Slows down on the floor and then rests.
  const auto lands = [](int frame) {
    return Eigen::Vector3d(0.009 * std::min(frame, 30), 0.0, 0.03);
  };
  const auto found = contacts(source_with(kLeftHand, 60, lands), kLeftHand);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GE(found[0].begin, 29);
}

TEST(BodyContacts, HandThatCarriesTheWholeBodyStandsOnItsFingers) {
  const auto still = [](int) { return Eigen::Vector3d(0.0, 0.0, 0.19); };
  SourceFeet source = source_with(kLeftHand, 30, still);
  for (SourceFoot& foot : source.feet) foot.ankle.z() = foot.toe.z() = 1.2;
  EXPECT_THAT(contacts(source, kLeftHand), ElementsAre(ContactPhase{0, 30}));
  // A foot carries the body.
  for (SourceFoot& foot : source.feet) foot.toe.z() = 0.02;
  EXPECT_THAT(contacts(source, kLeftHand), IsEmpty());
}

TEST(SlideTracker, RollingInPlaceIsNotASlide) {
  SlideTracker tracker({1.0, 2.0, 0.1}, 0.04);
  for (int step = 0; step < 100; ++step) {
    const double angle = 0.3 * step;
    const Eigen::Vector3d joint(1.0 + 0.039 * std::cos(angle), 2.0 + 0.039 * std::sin(angle), 0.1);
    EXPECT_EQ(tracker.follow(joint).norm(), 0.0);
  }
}

TEST(SlideTracker, FollowsALongSlideAndLagsWhenItReturns) {
  SlideTracker tracker({0.0, 0.0, 0.1}, 0.04);
  Eigen::Vector2d slide = Eigen::Vector2d::Zero();
  for (int step = 0; step <= 100; ++step) slide = tracker.follow({0.0, -0.01 * step, 0.05});
  EXPECT_NEAR(slide.y(), -0.96, 1e-12);
  EXPECT_EQ(slide.x(), 0.0);
  EXPECT_NEAR(tracker.follow({0.0, -0.93, 0.05}).y(), -0.96, 1e-12);
  EXPECT_NEAR(tracker.follow({0.0, -0.90, 0.05}).y(), -0.94, 1e-12);
}

TEST(BodyContacts, IgnoreShortTouches) {
  const auto still = [](int begin, int end, int step) {
    return [=](int frame) {
      return Eigen::Vector3d(0.0, 0.0, frame >= begin && frame < end ? 0.05 : 0.05 + 0.01 * step);
    };
  };
  // Two frames at 30 fps last less than 0.1 s, eight at 120 fps do not.
  EXPECT_THAT(contacts(source_with(kLeftKnee, 20, still(8, 10, 10)), kLeftKnee), IsEmpty());
  EXPECT_THAT(contacts(source_with(kLeftKnee, 80, still(30, 50, 10), 120.0), kLeftKnee),
              testing::SizeIs(1));
}

TEST(BodyContacts, AreIndependentOfTheRate) {
  const auto down = [](double fps) {
    return [fps](int frame) {
      const double t = frame / fps;
      return Eigen::Vector3d(0.0, 0.0, 0.05 + std::max(0.0, std::abs(t - 1.0) - 0.5));
    };
  };
  for (const double fps : {24.0, 30.0, 50.0, 120.0}) {
    const auto source = source_with(kLeftKnee, static_cast<int>(2 * fps), down(fps), fps);
    const auto found = contacts(source, kLeftKnee);
    ASSERT_EQ(found.size(), 1U) << fps;
    EXPECT_NEAR(found[0].begin / fps, 0.5, 0.06) << fps;
    EXPECT_NEAR(found[0].end / fps, 1.5, 0.06) << fps;
  }
}

TEST(BodyContacts, AreEmptyWithoutFeet) {
  SourceFeet source = source_with(kLeftKnee, 30, [](int) { return Eigen::Vector3d::Zero(); });
  source.foot_count = 0;
  BodyContacts all;
  all[0].push_back({0, 10});  // A phase of another source.
  find_body_contacts(source, kStanding, 1.0, {}, all);
  for (const auto& phases : all) EXPECT_THAT(phases, IsEmpty());
}

TEST(BodyContacts, HaveAFrameWithoutAShortestTime) {
  const auto down_once = [](int frame) {
    return Eigen::Vector3d(0.0, 0.0, frame >= 20 && frame < 30 ? 0.05 : 0.4);
  };
  const SourceFeet source = source_with(kLeftKnee, 60, down_once);
  ContactOptions options;
  options.shortest = 0.0;
  BodyContacts all;
  find_body_contacts(source, kStanding, 1.0, options, all);
  EXPECT_THAT(all[kLeftKnee], ElementsAre(ContactPhase{21, 29}));
  EXPECT_THAT(all[kLeftHand], IsEmpty());
}

}  // namespace
}  // namespace retarget
