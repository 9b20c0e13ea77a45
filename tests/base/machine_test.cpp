#include "retarget/machine.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

TEST(Machine, ReportsProcessorsAndMemory) {
  EXPECT_GE(usable_cores(), 1);
  EXPECT_GT(usable_memory(), std::uint64_t{1} << 20U);
}

// Control groups of both versions, in the system's format.
class ControlGroups : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    folder_.write(name, text);
  }
  [[nodiscard]] ControlGroupFiles files() const {
    return {folder_.path().string(), (folder_.path() / "membership").string()};
  }
  const TemporaryFolder folder_;
};

TEST_F(ControlGroups, Version2LimitsProcessorsAndMemory) {
  write("membership", "0::/system/job\n");
  write("system/job/cpu.max", "max 100000\n");
  write("system/job/memory.max", "max\n");
  EXPECT_EQ(usable_cores(files()), usable_cores({"none", "none"}));
  EXPECT_EQ(usable_memory(files()), usable_memory({"none", "none"}));
  // The limit of the parent group also applies.
  write("system/cpu.max", "50000 100000\n");
  write("system/memory.max", "300000000\n");
  EXPECT_EQ(usable_cores(files()), 1);
  EXPECT_EQ(usable_memory(files()), 300'000'000U);
}

TEST_F(ControlGroups, Version1LimitsProcessorsAndMemory) {
  write("membership", "5:memory:/job\n4:cpu,cpuacct:/job\n");
  write("cpu/job/cpu.cfs_quota_us", "-1\n");
  write("cpu/job/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(usable_cores(files()), usable_cores({"none", "none"}));
  write("cpu/job/cpu.cfs_quota_us", "90000\n");
  write("memory/job/memory.limit_in_bytes", "200000000\n");
  EXPECT_EQ(usable_cores(files()), 1);
  EXPECT_EQ(usable_memory(files()), 200'000'000U);
}

}  // namespace
}  // namespace retarget
