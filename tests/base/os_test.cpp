#include "retarget/os.h"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "retarget/file.h"
#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// German, Japanese, and a character of two UTF-16 units.
const std::string kName =
    "Gr\xc3\xb6\xc3\x9f"
    "e \xe6\xad\xa9\xe3\x81\x8f \xf0\x9f\x98\x80";

class OsTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const {
    return folder_.path().string() + "/" + name;
  }
  const TemporaryFolder folder_;
};

TEST_F(OsTest, NamesAreUtf8) {
  ASSERT_EQ(os::make_folder(at(kName)), 0);
  const std::string file = at(kName + "/" + kName + ".csv");
  ASSERT_TRUE(write_file(file, "text").has_value());
  ASSERT_EQ(files_in_folder(at(kName)).size(), 1U);
  EXPECT_EQ(files_in_folder(at(kName)).front().filename().string(), kName + ".csv");
  EXPECT_EQ(fs::path(kName).string(), kName);
  const std::u8string utf8 = fs::path(kName).u8string();
  EXPECT_EQ(std::string(utf8.begin(), utf8.end()), kName);
  EXPECT_TRUE(is_file(file));
  EXPECT_EQ(read_file(file).value().view(), "text");
  std::ifstream stream(fs::path(file), std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "text");
}

// Files may hold any bytes as names.
TEST_F(OsTest, NamesThatAreNotUtf8DoNotThrow) {
  for (const char* name : {"\xff", "a\xc3", "\xe6\xad", "\xf0\x9f\x98", "\xc0\xaf", "\xed\xa0\x80",
                           "\xf8\x88\x80\x80\x80", "\x80\x80"}) {
    EXPECT_FALSE(is_file(fs::path(at("missing")) / name));
    EXPECT_FALSE(read_file(at(name)).has_value());
  }
}

TEST_F(OsTest, WritesBytesUnchanged) {
  const std::string bytes = "a\nb\r\nc\x1a\n";
  ASSERT_TRUE(write_file(at("a"), bytes).has_value());
  EXPECT_EQ(os::status_of(at("a")).value().bytes, bytes.size());
  EXPECT_EQ(read_file(at("a")).value().view(), bytes);
}

TEST_F(OsTest, StatusDistinguishesFiles) {
  folder_.write("a", "one");
  folder_.write("b", "two!");
  const auto a = os::status_of(at("a")), b = os::status_of(at("b"));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->kind, os::EntryKind::kRegular);
  EXPECT_EQ(b->bytes, 4U);
  EXPECT_NE(a->id, b->id);
  const int descriptor = os::open_file(at("a"), os::OpenFor::kReading);
  ASSERT_GE(descriptor, 0);
  EXPECT_EQ(os::status_of(descriptor).value().id, a->id);
  os::close_file(descriptor);
  EXPECT_EQ(os::status_of(at("")).value().kind, os::EntryKind::kFolder);
  // Some file systems, and some versions of last_write_time, count whole seconds.
  fs::last_write_time(at("a"), fs::last_write_time(at("a")) - std::chrono::seconds(10));
  const std::int64_t earlier = a->modified_ns - os::status_of(at("a")).value().modified_ns;
  EXPECT_NEAR(static_cast<double>(earlier), 1e10, 1e9);
  EXPECT_FALSE(os::status_of(at("c")));
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(OsTest, OpensForItsPurpose) {
  EXPECT_LT(os::open_file(at("a"), os::OpenFor::kReading), 0);
  EXPECT_EQ(errno, ENOENT);
  EXPECT_LT(os::open_file(at("a"), os::OpenFor::kAppending), 0);
  folder_.write("a", "text");
  EXPECT_LT(os::open_file(at("a"), os::OpenFor::kCreating), 0);
  EXPECT_EQ(errno, EEXIST);
  ASSERT_EQ(os::make_folder(at("folder")), 0);
  EXPECT_LT(os::open_file(at("folder"), os::OpenFor::kCreating), 0);
  EXPECT_EQ(errno, EEXIST);
  const int descriptor = os::open_file(at("a"), os::OpenFor::kAppending);
  ASSERT_GE(descriptor, 0);
  EXPECT_EQ(os::seek_end(descriptor), 4);
  EXPECT_EQ(os::write_bytes(descriptor, "more", 4), 4);
  EXPECT_EQ(os::flush_to_disk(descriptor, true), 0);
  EXPECT_EQ(read_file(at("a")).value().view(), "textmore");
  EXPECT_EQ(os::resize_file(descriptor, 5), 0);
  EXPECT_EQ(os::write_bytes(descriptor, "!", 1), 1);
  os::close_file(descriptor);
  EXPECT_EQ(read_file(at("a")).value().view(), "textm!");
  os::close_file(os::open_file(at("a"), os::OpenFor::kReplacing));
  EXPECT_EQ(read_file(at("a")).value().view(), "");
}

TEST_F(OsTest, ReadsAndWritesAtOffsets) {
  const int descriptor = os::open_file(at("a"), os::OpenFor::kLocking);
  ASSERT_GE(descriptor, 0);
  EXPECT_EQ(os::write_bytes_at(descriptor, "0123456789", 10, 0), 10);
  EXPECT_EQ(os::write_bytes_at(descriptor, "ab", 2, 4), 2);
  std::array<char, 4> bytes{};
  EXPECT_EQ(os::read_bytes_at(descriptor, bytes.data(), bytes.size(), 3), 4);
  EXPECT_EQ(std::string(bytes.data(), bytes.size()), "3ab6");
  EXPECT_EQ(os::read_bytes_at(descriptor, bytes.data(), bytes.size(), 10), 0);
  os::close_file(descriptor);
}

TEST_F(OsTest, MovesFilesAndFolders) {
  folder_.write("a", "new");
  folder_.write("b", "old");
  EXPECT_NE(os::move_to_new(at("a"), at("b")), 0);
  EXPECT_EQ(errno, EEXIST);
#ifdef _WIN32
  EXPECT_EQ(os::move_over(at("a"), at("b")), 0);
#else
  // Readers keep the old file.
  const int reader = os::open_file(at("b"), os::OpenFor::kReading);
  EXPECT_EQ(os::move_over(at("a"), at("b")), 0);
  std::array<char, 8> bytes{};
  EXPECT_EQ(os::read_bytes(reader, bytes.data(), bytes.size()), 3);
  EXPECT_EQ(std::string(bytes.data(), 3), "old");
  os::close_file(reader);
#endif
  EXPECT_EQ(read_file(at("b")).value().view(), "new");
  EXPECT_EQ(os::move_to_new(at("b"), at("c")), 0);
  EXPECT_FALSE(is_file(at("b")));
  EXPECT_EQ(os::make_folder(at("full")), 0);
  EXPECT_NE(os::make_folder(at("full")), 0);
  EXPECT_EQ(errno, EEXIST);
  folder_.write("full/file", "x");
  EXPECT_EQ(os::make_folder(at("empty")), 0);
  EXPECT_EQ(os::move_over(at("full"), at("empty")), 0);
  EXPECT_TRUE(is_file(at("empty/file")));
  EXPECT_EQ(os::make_folder(at("full")), 0);
  EXPECT_NE(os::move_over(at("full"), at("empty")), 0);
  EXPECT_TRUE(errno == ENOTEMPTY || errno == EEXIST);
}

TEST_F(OsTest, LocksExcludeOtherLocks) {
  const int a = os::open_file(at("lock"), os::OpenFor::kLocking);
  const int b = os::open_file(at("lock"), os::OpenFor::kLocking);
  ASSERT_TRUE(a >= 0 && b >= 0);
  EXPECT_EQ(os::lock_file(a, os::LockKind::kAlone), 0);
  EXPECT_NE(os::lock_file(b, os::LockKind::kShared), 0);
  EXPECT_EQ(errno, EWOULDBLOCK);
  EXPECT_EQ(os::lock_file(a, os::LockKind::kShared), 0);
  EXPECT_EQ(os::lock_file(b, os::LockKind::kShared), 0);
  EXPECT_NE(os::lock_file(a, os::LockKind::kAlone), 0);
  os::close_file(b);
  EXPECT_EQ(os::lock_file(a, os::LockKind::kAlone), 0);
  os::close_file(a);
}

TEST(Os, IdentifiesProcessAndMachine) {
  EXPECT_GT(os::process_id(), 0);
  EXPECT_FALSE(os::host_name().empty());
  EXPECT_TRUE(is_file(os::program_file()));
  EXPECT_GT(os::physical_memory(), std::uint64_t{1} << 20U);
}

}  // namespace
}  // namespace retarget
