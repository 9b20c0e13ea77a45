#include "base/faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace retarget {
namespace {

using ::testing::HasSubstr;

std::string message_of(const Faults& faults) {
  return full_message(faults.failure_in("file", "the file").value());
}

TEST(FaultsTest, ListsErrorsBelowTheirCount) {
  Faults faults;
  EXPECT_TRUE(faults.empty());
  faults.add("one");
  EXPECT_EQ(message_of(faults), "one");
  faults.add("two");
  EXPECT_EQ(message_of(faults), "2 errors in the file\n  - one\n  - two");
}

// A list of all errors of a completely invalid file would be unreadable.
TEST(FaultsTest, LimitsTheListLength) {
  Faults faults;
  for (int i = 0; i < 100'000; ++i) faults.add("fault " + std::to_string(i));
  const std::string message = message_of(faults);
  EXPECT_THAT(message, HasSubstr("100000 errors in the file"));
  EXPECT_THAT(message, HasSubstr("- fault 99\n  - and 99900 more"));
  EXPECT_LT(message.size(), 3000U);
}

TEST(FaultsTest, SuggestsOnlyForListedErrors) {
  const std::vector<std::string> names = {"left_knee"};
  Faults faults;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(faults.suggestion("left_kneee", names), " (did you mean \"left_knee\"?)");
    faults.add("fault");
  }
  EXPECT_EQ(faults.suggestion("left_kneee", names), "");
}

TEST(FaultsTest, TruncatesLongTexts) {
  Faults faults;
  std::string name;
  for (int i = 0; i < 100'000; ++i) name += "\xC3\xA4";
  faults.add("x" + name);
  const std::string message = message_of(faults);
  EXPECT_LT(message.size(), 5000U);
  // Characters are never split.
  EXPECT_EQ(message.substr(message.size() - 5), "\xC3\xA4...");
}

}  // namespace
}  // namespace retarget
