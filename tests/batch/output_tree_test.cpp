#include "batch/output_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <csignal>
#include <filesystem>
#include <string>

#include "retarget/os.h"
#include "support/temporary_folder.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using Kind = FolderLock::Kind;

TEST(FolderLockTest, SecondLockIsRejectedWithTheHolder) {
  const TemporaryFolder folder;
  auto first = FolderLock::take(folder.path().string(), ".lock", Kind::kAlone);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->is_held());
  for (const Kind kind : {Kind::kAlone, Kind::kShared}) {
    const auto second = FolderLock::take(folder.path().string(), ".lock", kind);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kRun);
    EXPECT_THAT(second.error().message, HasSubstr("process " + std::to_string(os::process_id())));
  }
}

TEST(FolderLockTest, SharedLocksExcludeOnlyExclusiveOnes) {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  {
    auto first = FolderLock::take(path, ".lock", Kind::kShared);
    auto second = FolderLock::take(path, ".lock", Kind::kShared);
    ASSERT_TRUE(first);
    ASSERT_TRUE(second);
    EXPECT_FALSE(FolderLock::take(path, ".lock", Kind::kAlone));
    first = failure(Error{});
    EXPECT_TRUE(std::filesystem::exists(folder.path() / ".lock"));
    EXPECT_FALSE(FolderLock::take(path, ".lock", Kind::kAlone));
  }
  EXPECT_TRUE(FolderLock::take(path, ".lock", Kind::kAlone));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

#ifndef _WIN32  // forks
TEST(FolderLockTest, LockOfAKilledProcessIsReleased) {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    auto lock = FolderLock::take(path, ".lock", Kind::kAlone);
    const char sign = lock ? 'y' : 'n';
    if (::write(ready[1], &sign, 1) == 1) ::pause();
    ::_exit(0);
  }
  char sign = 0;
  ASSERT_EQ(::read(ready[0], &sign, 1), 1);
  EXPECT_EQ(sign, 'y');
  const auto refused = FolderLock::take(path, ".lock", Kind::kAlone);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("process " + std::to_string(child)));
  ::kill(child, SIGKILL);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / ".lock"));
  EXPECT_TRUE(FolderLock::take(path, ".lock", Kind::kAlone));
  ::close(ready[0]);
  ::close(ready[1]);
}
#endif

TEST(FolderLockTest, UnwritableFolderIsAnError) {
  const auto lock = FolderLock::take("/no/such/folder", ".lock", Kind::kAlone);
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().kind, ErrorKind::kRun);
}

}  // namespace
}  // namespace retarget
