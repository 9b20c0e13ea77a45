// Standing feet, and lying feet at the height of standing ones.

#include "human/gait/contact_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <numbers>

#include "retarget/human_skeleton.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Degrees of a foot's rotation about a world axis.
using Turn = std::function<double(int frame)>;

HumanClip human_with_left_foot(int frames, const Eigen::Vector3d& axis, const Turn& turn) {
  HumanClip human;
  human.rate = {30, 1};
  human.frame_count = frames;
  human.sources = BoneArray<std::string>("joint");
  human.world_from_bone.resize(static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame) {
    for (const Bone bone : kAllBones) {
      Eigen::Quaterniond rotation(canonical_t_pose(bone));
      if (bone_name(bone) == "LeftFoot") {
        const double angle = turn(frame) * std::numbers::pi / 180.0;
        rotation = Eigen::AngleAxisd(angle, axis) * rotation;
      }
      human.world_from_bone[static_cast<std::size_t>(frame)][bone].rotation = rotation;
    }
  }
  return human;
}

struct Stances {
  std::array<std::vector<ContactPhase>, 2> phases;  // of the left and the right foot
};

ContactPhase planted(int begin, int end) {
  return {begin, end};
}

// Stances of a human with both feet planted in those frames.
Stances stances_of(const HumanClip& human, const ContactPhase& phase) {
  const SourceFeet feet(human, human.frame_count);
  const double shortest = ContactOptions().shortest;
  Stances found;
  for (int foot = 0; foot < 2; ++foot) {
    phases_on_sole(feet, foot, {phase}, shortest, found.phases[static_cast<std::size_t>(foot)]);
  }
  return found;
}

TEST(Stances, MatchContactsOfStandingFeet) {
  const HumanClip human =
      human_with_left_foot(30, Eigen::Vector3d::UnitY(), [](int) { return 40.0; });
  const Stances found = stances_of(human, planted(3, 20));
  EXPECT_THAT(found.phases[0], ElementsAre(ContactPhase{3, 20}));
  EXPECT_THAT(found.phases[1], ElementsAre(ContactPhase{3, 20}));
}

TEST(Stances, ExcludeFeetOnTheInstepOrEdge) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0)}) {
    for (const double angle : {45.0, 90.0, 170.0}) {
      const HumanClip human = human_with_left_foot(30, axis, [&](int) { return angle; });
      const Stances found = stances_of(human, planted(3, 20));
      EXPECT_THAT(found.phases[0], IsEmpty()) << axis.transpose() << ", " << angle;
      EXPECT_THAT(found.phases[1], ElementsAre(ContactPhase{3, 20}));
    }
  }
  // For any facing direction.
  const HumanClip turned =
      human_with_left_foot(30, Eigen::Vector3d::UnitZ(), [](int frame) { return 12.0 * frame; });
  EXPECT_THAT(stances_of(turned, planted(3, 20)).phases[0], ElementsAre(ContactPhase{3, 20}));
}

TEST(Stances, ArePartsOfContactsUnlessTooShort) {
  // On its edge in frames 8 and 18; 2 frames remain after the second.
  const HumanClip human = human_with_left_foot(30, Eigen::Vector3d::UnitX(), [](int frame) {
    return frame == 8 || frame == 18 ? 80.0 : 0.0;
  });
  EXPECT_THAT(stances_of(human, planted(3, 21)).phases[0],
              ElementsAre(ContactPhase{3, 8}, ContactPhase{9, 18}));
  // A contact that was already short is kept.
  EXPECT_THAT(stances_of(human, planted(3, 5)).phases[0], ElementsAre(ContactPhase{3, 5}));
}

}  // namespace
}  // namespace retarget
