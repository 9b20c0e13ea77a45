#include "human/gait/contact_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kLeg = 0.85;
constexpr FrameRate kRate{30, 1};

// Paths of a foot's joints; empty if the foot lacks a joint.
struct FootTrack {
  std::vector<Eigen::Vector3d> ankle, toe;
};

ContactPlan contacts_of(const std::array<FootTrack, 2>& tracks, double leg, const FrameRate& rate,
                        const ContactOptions& options = {}, std::vector<double> hips = {}) {
  SourceFeet feet;
  feet.hips = std::move(hips);
  feet.frame_time = rate.frame_time();
  feet.foot_count = 2;
  feet.legs = {leg};
  std::size_t frames = 0;
  for (const std::size_t foot : {0, 1}) {
    feet.has_ankle[foot] = !tracks[foot].ankle.empty();
    feet.has_toe[foot] = !tracks[foot].toe.empty();
    frames = std::max(frames, tracks[foot].ankle.size());
  }
  for (std::size_t frame = 0; frame < frames; ++frame) {
    for (const FootTrack& track : tracks) {
      SourceFoot& foot = feet.feet.emplace_back();
      if (!track.ankle.empty()) foot.ankle = track.ankle[frame];
      if (!track.toe.empty()) foot.toe = track.toe[frame];
    }
  }
  return find_contacts(feet, options);
}

FootTrack standing_foot(int frames, double side) {
  FootTrack foot;
  foot.ankle.assign(frames, {0.0, side, 0.08});
  foot.toe.assign(frames, {0.14, side, 0.02});
  return foot;
}

std::array<FootTrack, 2> standing_feet(int frames) {
  return {standing_foot(frames, 0.1), standing_foot(frames, -0.1)};
}

TEST(ContactPlan, StandingFeetArePlantedThroughout) {
  const ContactPlan contacts = contacts_of(standing_feet(30), kLeg, kRate);
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 30}));
  EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{0, 30}));
  EXPECT_DOUBLE_EQ(contacts.scale, 1.0);
  EXPECT_DOUBLE_EQ(contacts.standing.toe, 0.02);
  EXPECT_DOUBLE_EQ(contacts.standing.ankle, 0.08);
  EXPECT_TRUE(contacts.in_contact(0, 0));
  EXPECT_TRUE(contacts.in_contact(1, 29));
  EXPECT_FALSE(contacts.in_contact(1, 30));
}

TEST(ContactPlan, TheStandingAnkleHeightIsLearnedFromTheClip) {
  auto feet = standing_feet(30);
  for (auto& foot : feet) {
    for (auto& ankle : foot.ankle) ankle.z() = 0.20;  // High heels.
  }
  const ContactPlan contacts = contacts_of(feet, kLeg, kRate);
  EXPECT_DOUBLE_EQ(contacts.standing.ankle, 0.20);
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 30}));
}

TEST(ContactPlan, AFootOnItsSideIsNotInContact) {
  auto feet = standing_feet(60);
  for (int i = 40; i < 60; ++i) feet[0].ankle[i].z() = 0.03;
  const ContactPlan contacts = contacts_of(feet, kLeg, kRate);
  // The frame before the fall is already fast.
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 39}));
  EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{0, 60}));
}

// 20 frames of rest, then 20 frames of gliding at a constant speed, then rest again.
std::array<FootTrack, 2> gliding_feet(double speed) {
  auto feet = standing_feet(60);
  double x = 0.0;
  for (int i = 0; i < 60; ++i) {
    if (i > 20 && i <= 40) x += speed / 30.0;
    feet[0].ankle[i].x() += x;
    feet[0].toe[i].x() += x;
  }
  return feet;
}

TEST(ContactPlan, SpeedsHaveHysteresis) {
  const auto phases = [](double speed) {
    return contacts_of(gliding_feet(speed), kLeg, kRate).phases[0];
  };
  EXPECT_THAT(phases(0.24), ElementsAre(ContactPhase{0, 60}));
  // Central differences: half the speed in frames 20 and 40, so these still belong to it.
  EXPECT_THAT(phases(0.26), ElementsAre(ContactPhase{0, 21}, ContactPhase{40, 60}));
}

TEST(ContactPlan, AContactBeginsOnlyBelowTheLowerThresholds) {
  auto feet = standing_feet(60);
  for (int i = 0; i < 30; ++i) feet[0].toe[i].z() = feet[0].ankle[i].z() = 0.11;
  for (int i = 30; i < 60; ++i) feet[0].toe[i].z() = feet[0].toe[i].z() + 0.05;
  feet[0].ankle.assign(60, {0.0, 0.1, 0.08});
  // 5 cm is low enough to stay in contact, but not to enter contact.
  EXPECT_THAT(contacts_of(feet, kLeg, kRate).phases[0], IsEmpty());
}

TEST(ContactPlan, IgnoresShortContacts) {
  for (const int length : {2, 3}) {
    auto feet = standing_feet(30);
    for (int i = 0; i < 30; ++i) {
      if (i < 10 || i >= 10 + length) feet[1].toe[i].z() = 0.2;
    }
    // The speed limits are out of reach, because a jumping foot is fast in the adjacent frames too:
    // only the height decides.
    ContactOptions options;
    options.begin_speed = options.end_speed = 100.0;
    const ContactPlan contacts = contacts_of(feet, kLeg, kRate, options);
    if (length == 2) {
      EXPECT_THAT(contacts.phases[1], IsEmpty());
    } else {
      EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{10, 13}));
    }
  }
}

TEST(ContactPlan, MinimumDurationIsIndependentOfTheRate) {
  // A tenth of a second in whole frames, rounded up: 24 fps 3, 60 fps 6, 120 fps 12.
  for (const auto& [fps, frames] : {std::pair{24, 3}, {30, 3}, {60, 6}, {120, 12}, {7, 1}}) {
    const FrameRate rate{fps, 1};
    EXPECT_THAT(contacts_of(standing_feet(frames), kLeg, rate).phases[0],
                ElementsAre(ContactPhase{0, frames}))
        << fps;
    EXPECT_THAT(contacts_of(standing_feet(frames - 1), kLeg, rate).phases[0], IsEmpty()) << fps;
  }
}

TEST(ContactPlan, LengthsScaleWithTheLeg) {
  // A child of half the size with the same movement.
  auto feet = gliding_feet(0.26);
  for (auto& foot : feet) {
    for (auto* track : {&foot.ankle, &foot.toe}) {
      for (auto& point : *track) point *= 0.5;
    }
  }
  const ContactPlan contacts = contacts_of(feet, 0.5 * kLeg, kRate);
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 21}, ContactPhase{40, 60}));
  EXPECT_DOUBLE_EQ(contacts.scale, 0.5);
}

TEST(ContactPlan, HandlesVeryShortClips) {
  ContactOptions any;
  any.shortest = 0.0;
  for (const int frames : {1, 2}) {
    const auto feet = standing_feet(frames);
    EXPECT_THAT(contacts_of(feet, kLeg, kRate).phases[0], IsEmpty());
    EXPECT_THAT(contacts_of(feet, kLeg, kRate, any).phases[0],
                ElementsAre(ContactPhase{0, frames}));
  }
  EXPECT_THAT(contacts_of({}, kLeg, kRate).phases[0], IsEmpty());
}

TEST(ContactPlan, FeetWithoutToesAreJudgedByTheirAnkles) {
  auto feet = gliding_feet(0.26);
  for (auto& foot : feet) foot.toe.clear();
  const ContactPlan contacts = contacts_of(feet, kLeg, kRate);
  EXPECT_DOUBLE_EQ(contacts.standing.ankle, 0.08);
  EXPECT_DOUBLE_EQ(contacts.standing.toe, 0.02);
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 21}, ContactPhase{40, 60}));

  // One foot is sufficient to learn from.
  auto mixed = standing_feet(30);
  mixed[1].toe.clear();
  EXPECT_THAT(contacts_of(mixed, kLeg, kRate).phases[1], ElementsAre(ContactPhase{0, 30}));
  mixed[1].ankle.clear();
  EXPECT_THAT(contacts_of(mixed, kLeg, kRate).phases[1], IsEmpty());
}

TEST(ContactPlan, AFootOnAStepStandsOnIt) {
  auto feet = standing_feet(60);
  for (int i = 30; i < 60; ++i) {
    feet[0].ankle[i].z() += 0.3;
    feet[0].toe[i].z() += 0.3;
  }
  const ContactPlan contacts = contacts_of(feet, kLeg, kRate);
  ASSERT_EQ(contacts.phases[0].size(), 2U);
  EXPECT_EQ(contacts.phases[0][0], (ContactPhase{0, 29}));
  // The foot is fast in the frames next to a jump.
  EXPECT_EQ(contacts.phases[0][1].begin, 31);
  EXPECT_EQ(contacts.phases[0][1].end, 60);
  EXPECT_NEAR(contacts.phases[0][1].support, 0.3, 1e-12);
  EXPECT_THAT(on_floor(contacts.phases[0]), ElementsAre(ContactPhase{0, 29}));
  EXPECT_EQ(contacts.of_ends()[1], contacts.ends[0][kToeEnd].phases);
  EXPECT_EQ(contacts.soles[0], contacts.phases[0]);
}

// The heel rises by 5 cm in the last second, as before a step, so the whole run is not in place.
std::array<FootTrack, 2> foot_rolls_slowly_on_step() {
  auto feet = standing_feet(120);
  for (int i = 30; i < 120; ++i) {
    const double roll = 0.05 * std::max(0, i - 90) / 30.0;
    feet[0].ankle[i].z() += 0.5 + roll;
    feet[0].toe[i].z() += 0.5;
  }
  return feet;
}

TEST(ContactPlan, AFootThatRollsSlowlyOnAStepStandsOnItIfNothingElseCarriesTheBody) {
  auto feet = foot_rolls_slowly_on_step();
  for (int i = 30; i < 120; ++i) {
    feet[1].ankle[i].z() += 0.8;
    feet[1].toe[i].z() += 0.8;
    feet[1].ankle[i].x() += 0.02 * (i - 30);
    feet[1].toe[i].x() += 0.02 * (i - 30);
  }
  const std::vector<double> hips(120, 1.0);
  const ContactPlan contacts = contacts_of(feet, kLeg, kRate, {}, hips);
  ASSERT_EQ(contacts.phases[0].size(), 2U);
  EXPECT_EQ(contacts.phases[0][1].begin, 31);
  // 2 cm until frame 102, and 2 cm more after the stance.
  EXPECT_NEAR(contacts.phases[0][1].end, 113, 1);
  EXPECT_NEAR(contacts.phases[0][1].support, 0.5, 0.005);
  EXPECT_EQ(contacts.ends[0][kToeEnd].phases.back().end, 120);
  EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{0, 29}));
}

TEST(ContactPlan, AFootThatRollsSlowlyInTheAirIsNotInContactWhileTheOtherFootStands) {
  const std::vector<double> hips(120, 1.0);
  const ContactPlan contacts = contacts_of(foot_rolls_slowly_on_step(), kLeg, kRate, {}, hips);
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 29}));
  EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{0, 120}));
}

// The left toe is still for 8 frames on a stair while the heel passes over it; the right foot swings.
// @param stair  its height, metres.
std::array<FootTrack, 2> toe_on_stair(double stair = 0.5) {
  auto feet = standing_feet(60);
  for (int i = 20; i < 60; ++i) {
    const double swing = 0.06 * (i < 30 ? i - 30 : i > 37 ? i - 37 : 0);
    feet[0].ankle[i] += Eigen::Vector3d(0.02 * (i - 30), 0.0, stair);
    feet[0].toe[i] += Eigen::Vector3d(swing, 0.0, stair);
    feet[1].ankle[i] += Eigen::Vector3d(0.05 * (i - 30), 0.0, 0.4);
    feet[1].toe[i] += Eigen::Vector3d(0.05 * (i - 30), 0.0, 0.4);
  }
  return feet;
}

TEST(ContactPlan, AStillToeOnAStairCarriesABodyThatIsNotFalling) {
  const ContactPlan contacts =
      contacts_of(toe_on_stair(), kLeg, kRate, {}, std::vector<double>(60, 1.0));
  ASSERT_EQ(contacts.ends[0][kToeEnd].phases.size(), 2U);
  EXPECT_NEAR(contacts.ends[0][kToeEnd].phases[1].begin, 30, 1);
  EXPECT_NEAR(contacts.ends[0][kToeEnd].phases[1].end, 38, 1);
  EXPECT_NEAR(contacts.ends[0][kToeEnd].phases[1].support, 0.5, 1e-9);
  EXPECT_EQ(contacts.ends[0][kHeelEnd].phases.size(), 1U);
}

TEST(ContactPlan, AStillToeOnABumpOfTheFloorIsNotInContact) {
  const std::vector<double> hips(60, 1.0);
  const ContactPlan contacts = contacts_of(toe_on_stair(0.07), kLeg, kRate, {}, hips);
  EXPECT_EQ(contacts.ends[0][kToeEnd].phases.size(), 1U);
}

TEST(ContactPlan, AStillToeOfAFallingBodyIsNotInContact) {
  std::vector<double> hips(60);
  for (int i = 0; i < 60; ++i) hips[i] = 3.0 - 0.5 * 9.81 * i * i / 900.0;
  const ContactPlan contacts = contacts_of(toe_on_stair(), kLeg, kRate, {}, hips);
  EXPECT_EQ(contacts.ends[0][kToeEnd].phases.size(), 1U);
}

TEST(ContactPlan, HeelsAndToesHaveSeparateContacts) {
  auto feet = standing_feet(60);
  for (int i = 40; i < 60; ++i) feet[1].ankle[i].z() += 0.1;
  const ContactPlan contacts = contacts_of(feet, kLeg, kRate);
  EXPECT_THAT(contacts.ends[1][kHeelEnd].phases, ElementsAre(ContactPhase{0, 39}));
  EXPECT_THAT(contacts.ends[1][kToeEnd].phases, ElementsAre(ContactPhase{0, 60}));
  EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{0, 39}));
  EXPECT_TRUE(contacts.in_contact(1, kToeEnd, 50));
  EXPECT_FALSE(contacts.in_contact(1, kHeelEnd, 50));
  EXPECT_FALSE(contacts.in_contact(1, 50));
}

}  // namespace
}  // namespace retarget
