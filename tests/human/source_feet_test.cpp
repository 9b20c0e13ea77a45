#include "human/gait/source_feet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "human/gait/contact_plan.h"
#include "support/still_human.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

HumanClip standing_human(int frames, double left_leg) {
  std::vector<std::pair<std::string, Eigen::Vector3d>> places;
  for (const auto& [side, y, leg] : {std::tuple{"Left", 0.1, left_leg}, {"Right", -0.1, 0.9}}) {
    places.emplace_back(side + std::string("UpLeg"), Eigen::Vector3d(0.0, y, 0.08 + leg));
    places.emplace_back(side + std::string("Leg"), Eigen::Vector3d(0.0, y, 0.08 + 0.5 * leg));
    places.emplace_back(side + std::string("Foot"), Eigen::Vector3d(0.0, y, 0.08));
    places.emplace_back(side + std::string("Toe"), Eigen::Vector3d(0.14, y, 0.02));
  }
  return still_human(places, frames);
}

TEST(SourceFeet, AreFoundOnAStandingHuman) {
  const HumanClip human = standing_human(10, 0.8);
  EXPECT_DOUBLE_EQ(leg_length(human), 0.8);
  const ContactPlan contacts = find_contacts(human);
  EXPECT_DOUBLE_EQ(contacts.scale, 0.8 / 0.85);
  EXPECT_THAT(contacts.phases[0], ElementsAre(ContactPhase{0, 10}));
  EXPECT_THAT(contacts.phases[1], ElementsAre(ContactPhase{0, 10}));
}

TEST(SourceFeet, AreEmptyWithoutBones) {
  HumanClip human = standing_human(10, 0.8);
  human.sources[Bone::kLeftToe].clear();
  human.sources[Bone::kRightToe].clear();
  EXPECT_THAT(find_contacts(human).phases[0], ElementsAre(ContactPhase{0, 10}));

  human.sources[Bone::kLeftFoot].clear();
  EXPECT_DOUBLE_EQ(leg_length(human), 0.9);
  EXPECT_THAT(find_contacts(human).phases[0], IsEmpty());
  EXPECT_THAT(find_contacts(human).phases[1], ElementsAre(ContactPhase{0, 10}));

  human.sources[Bone::kRightLeg].clear();
  EXPECT_THAT(find_contacts(human).phases[1], IsEmpty());
}

TEST(SourceFeet, AreEmptyForAnEmptyClip) {
  HumanClip human = standing_human(0, 0.8);
  EXPECT_EQ(leg_length(human), 0.0);
  EXPECT_THAT(find_contacts(human).phases[0], IsEmpty());
}

}  // namespace
}  // namespace retarget
