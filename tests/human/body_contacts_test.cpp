// Contacts of knees, elbows, hands, seat and back of a human with the floor.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "human/gait/contact_plan.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr StandingHeights kStanding{0.08, 0.02, true};
constexpr std::size_t kLeftKnee = 0, kSeat = 6;

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
    if (i != support) EXPECT_THAT(all[i], IsEmpty()) << i;
  }
  return all[support];
}

TEST(BodyContacts, LowAndStillKneeIsInContact) {
  const auto down_from_20_to_50 = [](int frame) {
    return Eigen::Vector3d(0.0, 0.0, frame >= 20 && frame < 50 ? 0.05 : 0.4);
  };
  // It is not slow while it falls and rises.
  EXPECT_THAT(contacts(source_with(kLeftKnee, 80, down_from_20_to_50), kLeftKnee),
              ElementsAre(ContactPhase{21, 49}));
}

TEST(BodyContacts, UseTheHeightOfTheJoint) {
  const auto at = [](double height) {
    return [height](int) { return Eigen::Vector3d(0.0, 0.0, height); };
  };
  EXPECT_THAT(contacts(source_with(kLeftKnee, 30, at(0.14)), kLeftKnee), IsEmpty());
  EXPECT_THAT(contacts(source_with(kSeat, 30, at(0.14)), kSeat), ElementsAre(ContactPhase{0, 30}));
  // Half as high, for a body of half the size.
  EXPECT_THAT(contacts(source_with(kSeat, 30, at(0.14)), kSeat, 0.5), IsEmpty());
}

TEST(BodyContacts, SplitASlowSlideIntoSuccessiveContacts) {
  const auto slides = [](int frame) { return Eigen::Vector3d(0.1 * frame / 30.0, 0.0, 0.05); };
  const auto found = contacts(source_with(kLeftKnee, 60, slides), kLeftKnee);
  ASSERT_GE(found.size(), 4U);
  for (const ContactPhase& phase : found) {
    EXPECT_LE((phase.end - 1 - phase.begin) * 0.1 / 30.0, 0.04 + 1e-9);
  }
  const auto hurries = [](int frame) { return Eigen::Vector3d(0.4 * frame / 30.0, 0.0, 0.05); };
  EXPECT_THAT(contacts(source_with(kLeftKnee, 60, hurries), kLeftKnee), IsEmpty());
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
  all[0].push_back({0, 10});  // of another source
  find_body_contacts(source, kStanding, 1.0, {}, all);
  for (const auto& phases : all) EXPECT_THAT(phases, IsEmpty());
}

}  // namespace
}  // namespace retarget
