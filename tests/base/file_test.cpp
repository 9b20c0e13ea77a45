#include "retarget/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/resource.h>
#include <sys/stat.h>
#endif

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Every test has its own empty folder.
class FileTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      all.push_back(entry.path().filename().string());
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  void put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }

  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

#ifndef _WIN32
// Sets a file size limit for the lifetime of the object, with errors instead of the signal.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_before_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_before_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  void (*handler_before_)(int);
  rlimit before_{};
};
#endif

TEST_F(FileTest, ReadsWrittenFiles) {
  // Larger than the reader's first guess, and with every byte value.
  std::string bytes;
  for (int i = 0; i < 300'000; ++i) bytes.push_back(static_cast<char>(i % 256));
  ASSERT_TRUE(write_file(path("a"), bytes).has_value());
  const auto read = value_of(read_file(path("a")));
  EXPECT_EQ(read.view(), bytes);
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(FileTest, WritesAnEmptyFile) {
  ASSERT_TRUE(write_file(path("a"), "").has_value());
  EXPECT_EQ(fs::file_size(folder_ / "a"), 0U);
  const auto read = value_of(read_file(path("a")));
  EXPECT_EQ(read.view(), "");
}

TEST_F(FileTest, NothingIsVisibleBeforeCommit) {
  put("a", "old");
  auto file = value_of(OutputFile::create(path("a")));
  ASSERT_TRUE(file.write("new ").has_value());
  ASSERT_TRUE(file.write("text").has_value());
  EXPECT_EQ(content("a"), "old");
  ASSERT_TRUE(file.commit().has_value());
  EXPECT_EQ(content("a"), "new text");
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(FileTest, NothingRemainsWithoutCommit) {
  {
    auto file = value_of(OutputFile::create(path("a")));
    ASSERT_TRUE(file.write("half").has_value());
    OutputFile moved = std::move(file);
    ASSERT_TRUE(moved.write(" of it").has_value());
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(FileTest, SeveralOpenFilesDoNotInterfere) {
  auto a = OutputFile::create(path("a"));
  auto b = OutputFile::create(path("b"));
  auto again = OutputFile::create(path("a"));
  ASSERT_TRUE(a && b && again);
  ASSERT_TRUE(a->write("a") && b->write("b") && again->write("again"));
  ASSERT_TRUE(b->commit() && a->commit() && again->commit());
  EXPECT_EQ(content("a"), "again");
  EXPECT_EQ(content("b"), "b");
  EXPECT_THAT(names(), ElementsAre("a", "b"));
}

TEST_F(FileTest, AcceptsTheLongestFileName) {
  const std::string name(255, 'n');
  ASSERT_TRUE(write_file(path(name), "x").has_value());
  EXPECT_THAT(names(), ElementsAre(name));
}

#ifndef _WIN32  // links and limits of POSIX
TEST_F(FileTest, FullDeviceIsARunError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const auto written = write_file("/dev/full", "text");
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().kind, ErrorKind::kRun);
  EXPECT_EQ(written.error().location.file, "/dev/full");
  EXPECT_THAT(written.error().message, HasSubstr("No space left on device"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(FileTest, FileSizeLimitKeepsTheOldFile) {
  put("a", "old");
  const std::string bytes(100'000, 'x');
  {
    const FileSizeLimit limit(4096);
    const auto written = write_file(path("a"), bytes);
    ASSERT_FALSE(written.has_value());
    EXPECT_EQ(written.error().kind, ErrorKind::kRun);
    EXPECT_THAT(written.error().message, HasSubstr("File too large"));
  }
  EXPECT_EQ(content("a"), "old");
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(FileTest, FailedWriteCannotBeCommitted) {
  {
    const FileSizeLimit limit(4096);
    auto file = value_of(OutputFile::create(path("a")));
    EXPECT_FALSE(file.write(std::string(100'000, 'x')).has_value());
    EXPECT_FALSE(file.write("more").has_value());
    EXPECT_FALSE(file.commit().has_value());
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(FileTest, KeepsTheLinkAndReplacesItsTarget) {
  fs::create_directory(folder_ / "deep");
  put("deep/target", "old");
  fs::create_symlink("deep/target", folder_ / "second");
  fs::create_symlink("second", folder_ / "first");
  ASSERT_TRUE(write_file(path("first"), "new").has_value());
  EXPECT_TRUE(fs::is_symlink(folder_ / "first"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "second"));
  EXPECT_FALSE(fs::is_symlink(folder_ / "deep/target"));
  EXPECT_EQ(content("deep/target"), "new");
}

TEST_F(FileTest, CreatesTheMissingTargetOfALink) {
  fs::create_symlink("later", folder_ / "link");
  ASSERT_TRUE(write_file(path("link"), "new").has_value());
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content("later"), "new");
}

TEST_F(FileTest, LinkToAMissingFolderIsAUsageError) {
  fs::create_symlink("nowhere/later", folder_ / "link");
  const auto written = write_file(path("link"), "new");
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(names(), ElementsAre("link"));
}

TEST_F(FileTest, CircularLinkIsAnError) {
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  EXPECT_FALSE(read_file(path("a")).has_value());
  const auto written = write_file(path("a"), "new");
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().kind, ErrorKind::kRun);
  EXPECT_THAT(names(), ElementsAre("a", "b"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "a"));
}
#endif

TEST_F(FileTest, FolderAsOutputIsAnError) {
  const auto written = write_file(folder_.string(), "text");
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(written.error().message, HasSubstr("is a folder"));
}

TEST_F(FileTest, MissingFolderIsAUsageErrorThatNamesIt) {
  for (const auto& result :
       {check_output_folder(path("missing/a.csv")), write_file(path("missing/a.csv"), "text")}) {
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(result.error().message, HasSubstr(path("missing") + "\""));
    EXPECT_THAT(result.error().message, HasSubstr("does not exist"));
    EXPECT_THAT(result.error().hint, HasSubstr("mkdir -p"));
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(FileTest, FileInPlaceOfAFolderIsAUsageError) {
  put("file", "");
  const auto written = write_file(path("file/a.csv"), "text");
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(written.error().message, HasSubstr("is not a folder"));
}

TEST_F(FileTest, EmptyNameIsAUsageError) {
  const auto written = write_file("", "text");
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().kind, ErrorKind::kUsage);
}

TEST_F(FileTest, CheckOutputFolderAcceptsCurrentFolderAndStandardOutput) {
  EXPECT_TRUE(check_output_folder("a.csv").has_value());
  EXPECT_TRUE(check_output_folder("-").has_value());
  EXPECT_TRUE(check_output_folder(path("a.csv")).has_value());
}

#ifndef _WIN32  // pipes and devices with names
TEST_F(FileTest, WritesToAPipe) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] { received = read_file(path("pipe")).value().view(); });
  const auto written = write_file(path("pipe"), "through the pipe");
  reader.join();
  EXPECT_TRUE(written.has_value());
  EXPECT_EQ(received, "through the pipe");
  EXPECT_TRUE(fs::is_fifo(folder_ / "pipe"));
  EXPECT_THAT(names(), ElementsAre("pipe"));
}

TEST_F(FileTest, WritesToADeviceAndThroughALinkToOne) {
  EXPECT_TRUE(write_file("/dev/null", "text").has_value());
  fs::create_symlink("/dev/null", folder_ / "link");
  EXPECT_TRUE(write_file(path("link"), "text").has_value());
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}
#endif

TEST_F(FileTest, DashWritesStandardOutputAndKeepsItOpen) {
  ::testing::internal::CaptureStdout();
  EXPECT_TRUE(write_file("-", "one ").has_value());
  EXPECT_TRUE(write_file("-", "two").has_value());
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "one two");
}

TEST_F(FileTest, UnreadableInputsAreErrorsOfTheGivenKind) {
  const auto missing = read_file(path("missing"));
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().kind, ErrorKind::kInput);
  EXPECT_EQ(missing.error().location.file, path("missing"));
  EXPECT_THAT(missing.error().message, HasSubstr("No such file"));

  const auto folder = read_file(folder_.string(), ErrorKind::kConfig);
  ASSERT_FALSE(folder.has_value());
  EXPECT_EQ(folder.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(folder.error().message, HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace retarget
