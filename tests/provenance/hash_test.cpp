#include "retarget/hash.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// Examples of FIPS 180-4, and the result of sha256sum for no bytes.
constexpr const char* kHashOfNothing =
    "sha256:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* kAbc =
    "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr const char* kMillionA =
    "sha256:cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

TEST(HashTest, MatchesStandardTestVectors) {
  EXPECT_EQ(hash_bytes("").value(), kHashOfNothing);
  EXPECT_EQ(hash_bytes("abc").value(), kAbc);
  EXPECT_EQ(hash_bytes(std::string(1000000, 'a')).value(), kMillionA);
}

TEST(HashTest, IncrementalHashMatchesWhole) {
  auto hasher = value_of(ContentHasher::create());
  hasher.update("a");
  hasher.update("");
  hasher.update("bc");
  EXPECT_EQ(hasher.finish().value(), kAbc);
  EXPECT_FALSE(hasher.finish().has_value());
}

TEST(HashTest, HashesLargeFiles) {
  const TemporaryFolder folder;
  EXPECT_EQ(hash_file(folder.write("abc", "abc")).value(), kAbc);
  EXPECT_EQ(hash_file(folder.write("empty", "")).value(), kHashOfNothing);
  EXPECT_EQ(hash_file(folder.write("many", std::string(1000000, 'a'))).value(), kMillionA);
}

TEST(HashTest, ReportsMissingFiles) {
  const TemporaryFolder folder;
  const auto missing = hash_file((folder.path() / "missing").string(), ErrorKind::kConfig);
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().kind, ErrorKind::kConfig);
  EXPECT_NE(describe(missing.error()).find("missing: error: cannot read the file: No such file"),
            std::string::npos);
  EXPECT_FALSE(hash_file(folder.path().string()).has_value());
  const auto device = hash_file("/dev/zero");
  ASSERT_FALSE(device.has_value());
#ifndef _WIN32
  EXPECT_THAT(device.error().message, ::testing::HasSubstr("expected a regular file"));
#endif
}

}  // namespace
}  // namespace retarget
