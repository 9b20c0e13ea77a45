#include "human/gait/source_feet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "human/gait/contact_plan.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

HumanClip standing_human(int frames, double left_leg) {
  HumanClip human;
  human.frame_count = frames;
  human.sources = BoneArray<std::string>("");
  human.world_from_bone.resize(static_cast<std::size_t>(frames));
  const auto place = [&](const char* name, const Eigen::Vector3d& position) {
    const Bone bone = bone_from_name(name).value();
    human.sources[bone] = name;
    for (int i = 0; i < frames; ++i) {
      human.world_from_bone[static_cast<std::size_t>(i)][bone].translation = position;
    }
  };
  for (const auto& [side, y] : {std::pair{std::string("Left"), 0.1}, {"Right", -0.1}}) {
    const double leg = side == "Left" ? left_leg : 0.9;
    place((side + "UpLeg").c_str(), {0.0, y, 0.08 + leg});
    place((side + "Leg").c_str(), {0.0, y, 0.08 + 0.5 * leg});
    place((side + "Foot").c_str(), {0.0, y, 0.08});
    place((side + "Toe").c_str(), {0.14, y, 0.02});
  }
  return human;
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
