#include "retarget/file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string_view>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

TEST(PlainName, AcceptsASinglePathComponent) {
  for (const char* name : {"walk", "a b", ".hidden", "...", "läuft", "-", "x..y"}) {
    EXPECT_TRUE(is_plain_name(name)) << name;
  }
  for (const char* name : {"", ".", "..", "/", "a/b", "../a", "a\\b", "a\nb", "\x1b[2J", "\x7f"}) {
    EXPECT_FALSE(is_plain_name(name)) << name;
  }
  EXPECT_FALSE(is_plain_name(std::string_view("..\0x", 4)));
}

TEST(PlainName, AcceptsPathsInsideAFolder) {
  for (const char* path :
       {"walk.csv", "a/walk.csv", "a//b", "./a", "a..b/c", "new\nline", "...", "a b/c"}) {
    EXPECT_TRUE(is_plain_path(path)) << path;
  }
  for (const char* path :
       {"", ".", "./", "..", "../walk.csv", "a/../../b", "a/..", "/etc/passwd", "//a"}) {
    EXPECT_FALSE(is_plain_path(path)) << path;
  }
  EXPECT_FALSE(is_plain_path(std::string_view("a\0b", 3)));
}

#ifndef _WIN32  // creates links
TEST(PlainName, FollowsLinks) {
  const TemporaryFolder folder;
  const fs::path inside = folder.path() / "out";
  fs::create_directories(inside / "sub");
  folder.write("victim.txt", "victim");
  folder.write("out/sub/walk.csv", "walk");
  fs::create_symlink("../victim.txt", inside / "link.csv");
  fs::create_directory_symlink("..", inside / "up");
  fs::create_symlink("sub/walk.csv", inside / "near.csv");
  EXPECT_TRUE(lies_in(inside, "sub/walk.csv"));
  EXPECT_TRUE(lies_in(inside, "near.csv"));
  EXPECT_TRUE(lies_in(inside, "not yet there/walk.csv"));
  EXPECT_FALSE(lies_in(inside, "link.csv"));
  EXPECT_FALSE(lies_in(inside, "up/victim.txt"));
  EXPECT_FALSE(lies_in(inside, "../victim.txt"));
  // A folder with the same prefix.
  fs::create_directory(folder.path() / "outside");
  fs::create_directory_symlink("../outside", inside / "other");
  EXPECT_FALSE(lies_in(inside, "other/walk.csv"));
  // The folder itself may be a link.
  fs::create_directory_symlink("out", folder.path() / "alias");
  EXPECT_TRUE(lies_in(folder.path() / "alias", "sub/walk.csv"));
}
#endif

}  // namespace
}  // namespace retarget
