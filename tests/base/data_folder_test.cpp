#include "base/data_folder.h"
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
  // a folder below the root that holds robots/ and configs/
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
  // robots/ and configs/ alone may be anybody's
  EXPECT_FALSE(find_data_folder(search).has_value());
  fs::create_directories(source / "include/retarget");
  EXPECT_EQ(find_data_folder(search).value(), source);
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

TEST_F(DataFolderTest, ReadsTheEnvironment) {
  const fs::path folder = data_folder("by environment");
  ASSERT_EQ(::setenv("RETARGET_DATA_DIR", folder.c_str(), 1), 0);
  EXPECT_EQ(find_data_folder(std::nullopt).value(), folder);
  EXPECT_EQ(find_data_folder(data_folder("by flag").string()).value(), root_ / "by flag");
  ASSERT_EQ(::unsetenv("RETARGET_DATA_DIR"), 0);
}

}  // namespace
}  // namespace retarget
