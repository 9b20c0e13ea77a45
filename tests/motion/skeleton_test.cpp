#include "retarget/clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motion/test_clips.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;

TEST(Channel, KindsAxesAndNames) {
  EXPECT_TRUE(is_position(Channel::kXPosition));
  EXPECT_TRUE(is_position(Channel::kZPosition));
  EXPECT_FALSE(is_position(Channel::kXRotation));
  EXPECT_FALSE(is_rotation(Channel::kZPosition));
  EXPECT_TRUE(is_rotation(Channel::kXRotation));
  EXPECT_TRUE(is_rotation(Channel::kZRotation));
  EXPECT_FALSE(is_rotation(Channel::kXScale));
  EXPECT_EQ(axis_of(Channel::kXPosition), 0);
  EXPECT_EQ(axis_of(Channel::kYRotation), 1);
  EXPECT_EQ(axis_of(Channel::kZScale), 2);
  EXPECT_EQ(channel_name(Channel::kXPosition), "Xposition");
  EXPECT_EQ(channel_name(Channel::kZRotation), "Zrotation");
  EXPECT_EQ(channel_name(Channel::kYScale), "Yscale");
}

TEST(Skeleton, CountsChannelsAndTranslations) {
  const auto tree = make_tree();
  EXPECT_EQ(tree->joint_count(), 5);
  EXPECT_EQ(tree->channel_count(), 6 + 3 + 3 + 6 + 3);
  EXPECT_EQ(tree->translated_count(), 2);
  EXPECT_EQ(tree->translation_slot(0), 0);
  EXPECT_EQ(tree->translation_slot(1), -1);
  EXPECT_EQ(tree->translation_slot(2), -1);
  EXPECT_EQ(tree->translation_slot(3), 1);
  EXPECT_EQ(tree->translation_slot(4), -1);
}

TEST(Skeleton, OnePositionChannelGivesATranslation) {
  const Skeleton lift({make_joint("Root", -1, {0, 0, 0}, {}),
                       make_joint("Lift", 0, {0, 1, 0}, {Channel::kYPosition}),
                       make_joint("Scaled", 1, {0, 1, 0}, {Channel::kXScale})});
  EXPECT_EQ(lift.translation_slot(0), -1);
  EXPECT_EQ(lift.translation_slot(1), 0);
  EXPECT_EQ(lift.translation_slot(2), -1);
}

TEST(Skeleton, FindsTheFirstJointWithAName) {
  const Skeleton skeleton({make_joint("Root", -1, {0, 0, 0}), make_joint("Twin", 0, {1, 0, 0}),
                           make_joint("Twin", 0, {2, 0, 0})});
  EXPECT_EQ(skeleton.find("Twin"), 1);
  EXPECT_EQ(skeleton.find("twin"), std::nullopt);
  EXPECT_EQ(skeleton.find(""), std::nullopt);
  EXPECT_THAT(skeleton.names(), ElementsAre("Root", "Twin", "Twin"));
}

}  // namespace
}  // namespace retarget
