// Heights of feet above a floor on which other parts of the body rest.

#include "human/gait/standing_heights.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "formats/bvh/read_bvh.h"
#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "human/skeleton/calibrate.h"
#include "retarget/human.h"
#include "support/lafan1_map.h"
#include "support/shared_data.h"

namespace retarget {
namespace {

constexpr std::size_t kLeftWrist = 4, kRightWrist = 5, kHead = 2;

// A body whose feet point up 1.9 m above z = `floor`. All other parts are 1 m above it.
SourceFeet body_upside_down(double floor, int frames = 60) {
  SourceFeet source;
  source.foot_count = 2;
  source.has_support.fill(true);
  source.has_upper.fill(true);
  for (int frame = 0; frame < frames; ++frame) {
    for (const double side : {0.1, -0.1}) {
      SourceFoot& foot = source.feet.emplace_back();
      foot.ankle = {0.0, side, floor + 1.75};
      foot.toe = {0.02, side, floor + 1.9};
      foot.up = foot.sole_up = -0.1;
    }
    for (std::size_t i = 0; i < kSupportBones.size(); ++i) {
      source.supports.emplace_back(0.0, 0.0, floor + 1.0);
    }
    for (std::size_t i = 0; i < kUpperBones.size(); ++i)
      source.uppers.emplace_back(0.0, 0.0, floor + 1.0);
  }
  return source;
}

SourceFeet handstand(double floor, double wrist) {
  SourceFeet source = body_upside_down(floor);
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    for (const std::size_t hand : {kLeftWrist, kRightWrist}) {
      source.supports[static_cast<std::size_t>(frame) * kSupportBones.size() + hand].z() =
          floor + wrist;
    }
  }
  return source;
}

double floor_of(const SourceFeet& source) {
  const ContactPlan contacts = find_contacts(source);
  EXPECT_FALSE(contacts.standing.found);
  return floor_height(contacts);
}

TEST(StandingHeights, HandsOfAHandstandAreOnTheFloor) {
  const ContactPlan contacts = find_contacts(handstand(0.0, 0.08));
  EXPECT_TRUE(contacts.standing.from_body);
  EXPECT_DOUBLE_EQ(floor_height(contacts), 0.0);
  EXPECT_GT(contacts.standing.ankle, contacts.standing.toe);
  for (const std::size_t hand : {kLeftWrist, kRightWrist}) {
    ASSERT_EQ(contacts.bodies[hand].size(), 1u);
    EXPECT_EQ(contacts.bodies[hand][0], (ContactPhase{0, 60}));
  }
  for (const auto& foot : contacts.ends) {
    for (const EndContacts& end : foot) EXPECT_TRUE(end.phases.empty());
  }
}

// Known soles, such as a robot's, touch the floor with their toes.
TEST(StandingHeights, KnownSolesStandOnTheFloor) {
  SourceFeet source = handstand(0.0, 0.08);
  const SoleEnd end{.middle = {0.0, -0.05, 0.0}};
  source.soles = {FootSole{end, end}, FootSole{end, end}};
  for (SourceFoot& foot : source.feet) foot.heel = foot.ankle;
  const ContactPlan contacts = find_contacts(source);
  EXPECT_TRUE(contacts.standing.from_body);
  EXPECT_DOUBLE_EQ(contacts.standing.toe, 0.0);
  EXPECT_DOUBLE_EQ(contacts.standing.ankle, 0.05);
  EXPECT_DOUBLE_EQ(floor_height(contacts), 0.0);
  for (const std::size_t hand : {kLeftWrist, kRightWrist}) {
    EXPECT_EQ(contacts.bodies[hand].size(), 1u);
  }
}

TEST(StandingHeights, TheFloorOfAHandstandNeedNotBeAtZero) {
  for (const double floor : {-1.0, 0.5, 3.0}) {
    EXPECT_NEAR(floor_of(handstand(floor, 0.08)), floor, 0.03) << floor;
  }
}

TEST(StandingHeights, TheHeadOfAHeadstandIsOnTheFloor) {
  for (const double floor : {0.0, 0.5}) {
    SourceFeet source = body_upside_down(floor);
    for (int frame = 0; frame < source.frame_count(); ++frame) {
      source.uppers[static_cast<std::size_t>(frame) * kUpperBones.size() + kHead].z() =
          floor + 0.07;
    }
    EXPECT_NEAR(floor_of(source), floor, 0.03) << floor;
  }
}

TEST(StandingHeights, PartsBelowStandingFeetDoNotMatter) {
  SourceFeet source = handstand(0.0, -0.5);
  for (SourceFoot& foot : source.feet) {
    foot.ankle = {0.0, foot.ankle.y(), 0.08};
    foot.toe = {0.14, foot.ankle.y(), 0.02};
    foot.up = foot.sole_up = 1.0;
  }
  const StandingHeights standing = find_standing_heights(source);
  EXPECT_TRUE(standing.found);
  EXPECT_FALSE(standing.from_body);
  EXPECT_DOUBLE_EQ(standing.toe, 0.02);
}

// The feet of a body that crawls often have the pitch of standing feet, but their knees are low.
TEST(StandingHeights, FeetBehindKneesDoNotStand) {
  SourceFeet source = handstand(0.0, 0.08);
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    for (const std::size_t foot : {0, 1}) {
      SourceFoot& now = source.feet[2 * static_cast<std::size_t>(frame) + foot];
      now.ankle = {0.0, now.ankle.y(), 0.14};
      now.toe = {0.14, now.ankle.y(), 0.07};
      now.up = now.sole_up = 0.9;
      source.supports[static_cast<std::size_t>(frame) * kSupportBones.size() + foot].z() = 0.06;
    }
  }
  EXPECT_NEAR(floor_of(source), 0.0, 0.01);
}

// A frame with a hand that the tracking system lost does not lower the floor.
TEST(StandingHeights, AMomentDoesNotLowerTheFloor) {
  SourceFeet source = handstand(0.5, 0.08);
  for (int frame = 20; frame < 26; ++frame) {
    source.supports[static_cast<std::size_t>(frame) * kSupportBones.size() + kLeftWrist].z() = -2.0;
  }
  EXPECT_NEAR(floor_of(source), 0.5, 0.03);
}

// The hips sink below feet that had carried the body.
TEST(StandingHeights, FeetThatCarryTheBodyAreOnTheFloor) {
  SourceFeet source = handstand(0.5, -0.3);
  for (int frame = 0; frame < 24; ++frame) {
    for (const std::size_t foot : {0, 1}) {
      source.feet[2 * static_cast<std::size_t>(frame) + foot].ankle.z() = 0.63;
      source.feet[2 * static_cast<std::size_t>(frame) + foot].toe.z() = 0.52;
    }
    for (const std::size_t hand : {kLeftWrist, kRightWrist}) {
      source.supports[static_cast<std::size_t>(frame) * kSupportBones.size() + hand].z() = 1.5;
    }
  }
  EXPECT_NEAR(floor_of(source), 0.5, 0.03);
}

HumanClip human_of_file(const std::string& file) {
  const Clip clip = load_bvh(file).value().clip;
  return to_human(clip, calibrate(clip, lafan1_map(clip.skeleton(), "lafan1"), {}).value());
}

// Every excerpt of `seconds` in which feet stand, or in which no foot stands, once a second.
// @param farthest  of the excerpt's floor from that of the clip, metres.
// @return the number of these excerpts.
int expect_floor_of_excerpts(const HumanClip& human, double seconds, double farthest,
                             bool feet_stand = false) {
  const double floor = floor_height(find_contacts(human));
  const auto frames = static_cast<int>(seconds * human.rate.fps());
  int count = 0;
  for (int begin = 0; begin + frames <= human.frame_count; begin += 30) {
    SourceFeet source{static_cast<const HumanClipInfo&>(human)};
    for (int frame = begin; frame < begin + frames; ++frame) source.add(human.frame(frame));
    const ContactPlan contacts = find_contacts(source);
    if (!(feet_stand ? contacts.standing.found : contacts.standing.from_body)) continue;
    ++count;
    EXPECT_NEAR(floor_height(contacts), floor, farthest) << begin;
  }
  return count;
}

TEST(StandingHeights, ABeginningThatLiesHasTheFloorOfTheClip) {
  const HumanClip human = human_of_file(std::string(RETARGET_SOURCE_DIR) + "/data/get_up.bvh");
  EXPECT_GT(expect_floor_of_excerpts(human, 0.5, 0.01), 0);
}

TEST(StandingHeights, ExcerptsThatLieOrCrawlHaveTheFloorOfTheClip) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  for (const char* name : {"ground1_subject1", "fallAndGetUp2_subject2"}) {
    const auto file = *shared_folder() / "data/lafan1" / (std::string(name) + ".bvh");
    const HumanClip human = human_of_file(file.string());
    for (const double seconds : {2.0, 5.0}) {
      EXPECT_GT(expect_floor_of_excerpts(human, seconds, 0.02), 3) << name;
    }
    for (const double seconds : {5.0, 15.0}) {
      EXPECT_GT(expect_floor_of_excerpts(human, seconds, 0.025, true), 3) << name;
    }
  }
}

}  // namespace
}  // namespace retarget
