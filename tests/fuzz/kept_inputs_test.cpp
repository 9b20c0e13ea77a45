// Runs the seeds of the fuzzing targets, and inputs that once broke a reader, in every build.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/fuzz_target.h"

namespace retarget::fuzz {

// GoogleTest prints a target's name with this function.
static void PrintTo(const FuzzTarget& target, std::ostream* out) {
  *out << target.name;
}

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(folder, ignored)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

class KeptInputsTest : public testing::TestWithParam<FuzzTarget> {};

std::string name_of(const testing::TestParamInfo<FuzzTarget>& target) {
  return std::string(target.param.name);
}

// A violated property ends the process, after the name of the file.
TEST_P(KeptInputsTest, DoNotCrashTheReader) {
  const fs::path folder = fs::path(RETARGET_SOURCE_DIR) / "tests" / "fuzz";
  std::vector<fs::path> files = files_of(folder / "seeds" / GetParam().name);
  EXPECT_FALSE(files.empty()) << "no seeds for " << GetParam().name;
  std::ranges::copy(files_of(folder / "regressions" / GetParam().name), std::back_inserter(files));
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    std::cerr << file.filename().string() << std::endl;
    GetParam().run(bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, KeptInputsTest,
                         testing::ValuesIn(fuzz_targets().begin(), fuzz_targets().end()), name_of);

// An input without a target would never run.
TEST(KeptInputsTest, BelongToTargets) {
  for (const char* kind : {"seeds", "regressions"}) {
    const fs::path folder = fs::path(RETARGET_SOURCE_DIR) / "tests" / "fuzz" / kind;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      EXPECT_NE(find_fuzz_target(entry.path().filename().string()), nullptr) << entry.path();
    }
  }
}

}  // namespace
}  // namespace retarget::fuzz
