#include "retarget/motion_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace retarget {
namespace {

using ::testing::ElementsAre;

// Flags of the left heel; the right toe has the opposite.
FootContacts contacts_of(const std::vector<int>& left_heel) {
  FootContacts contacts;
  for (const int flag : left_heel) {
    const auto planted = static_cast<std::uint8_t>(flag);
    contacts.planted.insert(contacts.planted.end(),
                            {planted, 0, 0, static_cast<std::uint8_t>(1 - planted)});
  }
  return contacts;
}

std::vector<int> left_heel(const FootContacts& contacts) {
  std::vector<int> flags;
  for (int frame = 0; frame < contacts.frame_count(); ++frame) {
    flags.push_back(contacts.planted[4 * static_cast<std::size_t>(frame)]);
    EXPECT_EQ(contacts.planted[4 * static_cast<std::size_t>(frame) + 3], 1 - flags.back());
  }
  return flags;
}

TEST(FootContactsTest, SamplesTakeTheNearestFrame) {
  const FootContacts contacts = contacts_of({1, 0, 0, 1});
  // 30 to 60: halfway between two frames, the earlier one is used.
  EXPECT_THAT(left_heel(resample_contacts(contacts, {30, 1}, {60, 1}, 7)),
              ElementsAre(1, 1, 0, 0, 0, 0, 1));
  // 30 to 50: at frames 0, 0.6, 1.2, 1.8, 2.4.
  EXPECT_THAT(left_heel(resample_contacts(contacts, {30, 1}, {50, 1}, 5)),
              ElementsAre(1, 0, 0, 0, 0));
  EXPECT_THAT(left_heel(resample_contacts(contacts, {30, 1}, {10, 1}, 2)), ElementsAre(1, 1));
  // The last frame's contacts continue.
  EXPECT_THAT(left_heel(resample_contacts(contacts, {30, 1}, {30, 1}, 6)),
              ElementsAre(1, 0, 0, 1, 1, 1));
  EXPECT_EQ(resample_contacts({}, {30, 1}, {50, 1}, 3).frame_count(), 0);
}

TEST(FootContactsTest, AFootIsPlantedWithHeelOrToe) {
  const FootContacts contacts = contacts_of({1, 0});
  EXPECT_TRUE(contacts.foot_planted(0, 0));
  EXPECT_FALSE(contacts.foot_planted(0, 1));
  EXPECT_FALSE(contacts.foot_planted(1, 0));
  EXPECT_TRUE(contacts.foot_planted(1, 1));
}

TEST(FootContactsTest, TextHasAHeaderAndTimes) {
  EXPECT_EQ(format_contacts_csv(contacts_of({1, 0}), {30, 1}),
            "frame,time,left_heel,left_toe,right_heel,right_toe\n"
            "0,0.000000,1,0,0,0\n"
            "1,0.033333,0,0,0,1\n");
}

}  // namespace
}  // namespace retarget
