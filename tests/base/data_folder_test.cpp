#include "retarget/data_folder.h"
#include "base/option_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class DataFolderTest : public ::testing::Test {
 protected:
  // A folder below the root with robots/ and configs/.
  fs::path data_folder(const std::string& name) const {
    fs::create_directories(root_ / name / "robots");
    fs::create_directories(root_ / name / "configs");
    return root_ / name;
  }

  TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
};

TEST_F(DataFolderTest, FlagTakesPrecedence) {
  DataFolderSearch search;
  search.flag = data_folder("by flag").string();
  search.environment = data_folder("by environment").string();
  data_folder("prefix/share/retarget");
  search.executable = root_ / "prefix/bin/retarget";
  EXPECT_EQ(find_data_folder(search).value(), root_ / "by flag");
  search.flag.reset();
  EXPECT_EQ(find_data_folder(search).value(), root_ / "by environment");
  search.environment = "";
  EXPECT_EQ(find_data_folder(search).value(), root_ / "prefix/share/retarget");
}

TEST_F(DataFolderTest, UnusableChosenFolderIsAnError) {
  DataFolderSearch search;
  data_folder("prefix/share/retarget");
  search.executable = root_ / "prefix/bin/retarget";
  search.environment = (root_ / "nowhere").string();
  const auto by_environment = find_data_folder(search);
  ASSERT_FALSE(by_environment.has_value());
  EXPECT_EQ(by_environment.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(by_environment.error().message, HasSubstr("RETARGET_DATA_DIR"));

  fs::create_directories(root_ / "half/robots");
  search.flag = (root_ / "half").string();
  const auto by_flag = find_data_folder(search);
  ASSERT_FALSE(by_flag.has_value());
  EXPECT_EQ(by_flag.error().location.file, (root_ / "half").string());
  EXPECT_THAT(by_flag.error().message, HasSubstr(OPTION("data-dir") " has no folder configs/"));
}

TEST_F(DataFolderTest, FindsSourceTreeAboveTheBinary) {
  DataFolderSearch search;
  const fs::path source = data_folder("source");
  search.executable = source / "build/release/tools/retarget/retarget";
  // robots/ and configs/ alone may belong to another program.
  EXPECT_FALSE(find_data_folder(search).has_value());
  fs::create_directories(source / "include/retarget");
  EXPECT_EQ(find_data_folder(search).value(), source);
}

// A program built somewhere below a source tree uses its linked library.
TEST_F(DataFolderTest, InstalledLibraryComesBeforeASourceTree) {
  DataFolderSearch search;
  const fs::path source = data_folder("source");
  fs::create_directories(source / "include/retarget");
  search.executable = source / "build/program";
  search.installed = data_folder("prefix/share/retarget").string();
  EXPECT_EQ(find_data_folder(search).value(), search.installed);
  // The tree was moved afterwards.
  search.installed = (root_ / "gone").string();
  EXPECT_EQ(find_data_folder(search).value(), source);
  search.executable.clear();
  EXPECT_FALSE(find_data_folder(search).has_value());
}

// As for a package unpacked together with its program.
TEST_F(DataFolderTest, ProgramsOwnTreeComesBeforeTheInstalledLibrary) {
  DataFolderSearch search;
  search.executable = root_ / "package/bin/program";
  search.installed = data_folder("prefix/share/retarget").string();
  EXPECT_EQ(find_data_folder(search).value(), search.installed);
  const fs::path own = data_folder("package/share/retarget");
  EXPECT_EQ(find_data_folder(search).value(), own);
}

TEST_F(DataFolderTest, NothingFoundExplainsHowToSetTheFolder) {
  DataFolderSearch search;
  search.executable = root_ / "bin/retarget";
  const auto found = find_data_folder(search);
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(found.error().hint, HasSubstr(OPTION("data-dir")));
  EXPECT_THAT(found.error().hint, HasSubstr("RETARGET_DATA_DIR"));
  search.executable.clear();
  EXPECT_FALSE(find_data_folder(search).has_value());
}

// Without a value, removes the variable.
void set_variable(const std::string& name, const std::string& value = {}) {
#ifdef _WIN32
  ::_putenv((name + "=" + value).c_str());
#else
  static_cast<void>(value.empty() ? ::unsetenv(name.c_str())
                                  : ::setenv(name.c_str(), value.c_str(), 1));
#endif
}

TEST_F(DataFolderTest, ReadsTheEnvironment) {
  const fs::path folder = data_folder("by environment");
  set_variable("RETARGET_DATA_DIR", folder.string());
  EXPECT_EQ(find_data_folder(std::nullopt).value(), folder);
  EXPECT_EQ(find_data_folder(data_folder("by flag").string()).value(), root_ / "by flag");
  set_variable("RETARGET_DATA_DIR");
}

#ifndef _WIN32  // Elsewhere it is not below HOME.
TEST_F(DataFolderTest, TheUsersOwnFolderFollowsTheEnvironment) {
  const char* data = std::getenv("XDG_DATA_HOME");
  const char* home = std::getenv("HOME");
  const std::string old_data = data == nullptr ? "" : data, old_home = home == nullptr ? "" : home;
  ::setenv("HOME", "/home/somebody", 1);
  ::setenv("XDG_DATA_HOME", "/data", 1);
  EXPECT_EQ(user_data_folder(), "/data/retarget");
  // A relative path is ignored.
  ::setenv("XDG_DATA_HOME", "data", 1);
  EXPECT_EQ(user_data_folder(), "/home/somebody/.local/share/retarget");
  ::unsetenv("XDG_DATA_HOME");
  EXPECT_EQ(user_data_folder(), "/home/somebody/.local/share/retarget");
  ::unsetenv("HOME");
  EXPECT_EQ(user_data_folder(), std::nullopt);
  if (data != nullptr) ::setenv("XDG_DATA_HOME", old_data.c_str(), 1);
  if (home != nullptr) ::setenv("HOME", old_home.c_str(), 1);
}
#endif

}  // namespace
}  // namespace retarget
