#include "formats/containers/file_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "formats/bvh/read_bvh.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// An archive may hold any format.
TEST(FileKindTest, HintsAtArchivesNameNoFormat) {
  for (const std::string start : {"\x1f\x8b\x08", "PK\x03\x04", "Rar!", "7z\xbc\xaf"}) {
    const FileType type = file_type(start);
    EXPECT_THAT(std::string(type.hint), HasSubstr("unpack it"));
    EXPECT_THAT(std::string(type.hint), Not(HasSubstr(".bvh")));
  }
}

TEST(FileKindTest, AKnownTypeIsNotComparedWithBvh) {
  for (const std::string& text :
       {std::string("\xff\xfe<\0?\0x\0m\0l\0", 12), std::string("\x1f\x8b\x08\0", 4)}) {
    const auto read = read_bvh(text, "take.mvnx", {});
    ASSERT_FALSE(read.has_value());
    EXPECT_THAT(read.error().message, HasSubstr("expected a human motion, found"));
    EXPECT_THAT(read.error().message, Not(HasSubstr("HIERARCHY")));
  }
}

}  // namespace
}  // namespace retarget
