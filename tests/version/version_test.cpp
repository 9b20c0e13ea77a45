#include "retarget/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "version_numbers.h"

namespace retarget {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(VersionTest, ParsesMujocoVersions) {
  EXPECT_EQ(mujoco_version_text(222), "2.2.2");
  EXPECT_EQ(mujoco_version_text(337), "3.3.7");
  EXPECT_EQ(mujoco_version_text(3006000), "3.6.0");
  EXPECT_EQ(mujoco_version_text(3017002), "3.17.2");
  EXPECT_EQ(mujoco_version_text(4000000), "4.0.0");
}

TEST(VersionTest, MujocoTextMatchesTheLinkedLibrary) {
  EXPECT_EQ(mujoco_version_text(mj_version()), mj_versionString());
}

TEST(VersionTest, TextHasEveryPart) {
  EXPECT_THAT(version_number(), ContainsRegex("^[0-9]+\\.[0-9]+\\.[0-9]+$"));
  const std::string text = version_text();
  EXPECT_THAT(text, StartsWith("retarget " + version_number()));
  EXPECT_THAT(text, ContainsRegex("\ncompiler [A-Z]+"));
  EXPECT_THAT(text, HasSubstr(std::string("\nMuJoCo ") + mj_versionString()));
  EXPECT_THAT(text, ContainsRegex("\nEigen [0-9]+\\.[0-9]+\\.[0-9]+$"));
}

}  // namespace
}  // namespace retarget
