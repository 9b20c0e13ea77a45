// Compares files written by NumPy with the contents according to NumPy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/npz.h"
#include "retarget/file.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

class NpzFromNumpy : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string command = std::string("\"" RETARGET_PYTHON "\" -B \"") + RETARGET_SOURCE_DIR +
                                "/tests/base/write_npz.py\" \"" + folder_.path().string() + "\"";
    const int status = std::system(command.c_str());
    constexpr int kNoNumpy = 77;
    if (WIFEXITED(status) && WEXITSTATUS(status) == kNoNumpy) {
      GTEST_SKIP() << "the tests' Python (" RETARGET_PYTHON ") has no NumPy";
    }
    ASSERT_EQ(status, 0) << command;
    expected_ = nlohmann::json::parse(bytes_of("expected.json"));
  }

  [[nodiscard]] std::string bytes_of(const std::string& name) const {
    return std::string(value_of(read_file((folder_.path() / name).string())).view());
  }

  TemporaryFolder folder_;
  nlohmann::json expected_;
};

void expect_array(const NpyArray& array, const nlohmann::json& expected) {
  EXPECT_EQ(array.shape, expected["shape"].get<std::vector<std::size_t>>());
  ASSERT_EQ(array.is_number(), expected.contains("numbers"));
  if (array.is_number()) {
    EXPECT_EQ(array.numbers(), expected["numbers"].get<std::vector<double>>());
  } else {
    EXPECT_EQ(array.texts(), expected["texts"].get<std::vector<std::string>>());
  }
}

TEST_F(NpzFromNumpy, MatchesNumpy) {
  int arrays = 0;
  for (const auto& [name, content] : expected_.items()) {
    const std::string bytes = bytes_of(name);
    const auto file = value_of(NpzFile::open(bytes, name));
    const std::size_t refused = content.contains("refused") ? content["refused"].size() : 0;
    EXPECT_EQ(file.names().size(), content["arrays"].size() + refused) << name;
    for (const auto& [array_name, expected] : content["arrays"].items()) {
      SCOPED_TRACE(name + ": " + array_name);
      const auto array = value_of(file.read(array_name));
      expect_array(array, expected);
      ++arrays;
    }
  }
  EXPECT_GT(arrays, 100);
}

TEST_F(NpzFromNumpy, RejectsUnsupportedArraysByName) {
  int refused = 0;
  for (const auto& [name, content] : expected_.items()) {
    if (!content.contains("refused")) continue;
    const std::string bytes = bytes_of(name);
    const auto file = value_of(NpzFile::open(bytes, name));
    for (const auto& [array_name, word] : content["refused"].items()) {
      const Result<NpyArray> array = file.read(array_name);
      ASSERT_FALSE(array.has_value()) << array_name;
      EXPECT_EQ(array.error().location.file, name);
      EXPECT_THAT(array.error().message, HasSubstr("array \"" + array_name + "\": "));
      EXPECT_THAT(array.error().message, HasSubstr(word.get<std::string>()));
      ++refused;
    }
  }
  EXPECT_EQ(refused, 10);
}

TEST_F(NpzFromNumpy, DetectsTruncationAndCorruption) {
  for (const char* name : {"v1.npz", "streamed.npz"}) {
    const std::string bytes = bytes_of(name);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_FALSE(NpzFile::open(std::string_view(bytes).substr(0, size), name).has_value());
    }
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(~changed[at]);
      const Result<NpzFile> file = NpzFile::open(changed, name);
      if (!file || !file->has("poses")) continue;
      const Result<NpyArray> array = file->read("poses");
      if (!array) continue;
      SCOPED_TRACE(std::string(name) + ", byte " + std::to_string(at));
      expect_array(*array, expected_[name]["arrays"]["poses"]);
    }
  }
}

}  // namespace
}  // namespace retarget
