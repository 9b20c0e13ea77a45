#include "retarget/batch/worker_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;

TEST(WorkerPool, EveryTaskOnceByAnyNumberOfWorkers) {
  for (const int workers : {0, 1, 3, 16, 500}) {
    const std::vector<std::uint64_t> memory(200, 1);
    std::vector<std::atomic<int>> done(200);
    WorkerPoolOptions options;
    options.workers = workers;
    run_tasks(memory, options, [&](std::size_t task) { ++done[task]; });
    for (const auto& count : done) EXPECT_EQ(count, 1);
  }
}

TEST(WorkerPool, OneWorkerKeepsTheOrder) {
  const std::vector<std::uint64_t> memory = {5, 1, 9, 2};
  std::vector<std::size_t> order;
  run_tasks(memory, {1, 3, {}}, [&](std::size_t task) { order.push_back(task); });
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 3));
}

TEST(WorkerPool, NothingToDo) {
  run_tasks({}, {4, 0, {}}, [](std::size_t) { FAIL(); });
}

TEST(WorkerPool, TasksTogetherStayBelowTheBound) {
  // the first is larger than the bound and runs alone
  const std::vector<std::uint64_t> memory = {50, 8, 8, 8, 1, 1, 1, 8, 2, 7};
  std::mutex mutex;
  std::uint64_t used = 0, most = 0;
  std::size_t running = 0;
  bool alone = false;
  run_tasks(memory, {8, 10, {}}, [&](std::size_t task) {
    {
      const std::lock_guard lock(mutex);
      used += memory[task];
      ++running;
      if (task == 0) alone = running == 1;
      if (task != 0) most = std::max(most, used);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::lock_guard lock(mutex);
    if (task == 0) alone = alone && running == 1;
    used -= memory[task];
    --running;
  });
  EXPECT_TRUE(alone);
  EXPECT_LE(most, 10U);
  EXPECT_GE(most, 9U);
}

TEST(WorkerPool, NoFurtherTaskOnceStopped) {
  const std::vector<std::uint64_t> memory(1000, 1);
  std::atomic<int> begun = 0;
  std::atomic<bool> stop = false;
  WorkerPoolOptions options;
  options.workers = 2;
  options.keep_going = [&] { return !stop; };
  run_tasks(memory, options, [&](std::size_t) {
    ++begun;
    stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  EXPECT_GE(begun, 1);
  EXPECT_LT(begun, 100);
}

TEST(Machine, HasProcessorsAndMemory) {
  EXPECT_GE(usable_cores(), 1);
  EXPECT_GT(usable_memory(), std::uint64_t{1} << 20U);
}

// control groups of either version, as the system shows them
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

TEST_F(ControlGroups, OfVersion2LimitProcessorsAndMemory) {
  write("membership", "0::/system/job\n");
  write("system/job/cpu.max", "max 100000\n");
  write("system/job/memory.max", "max\n");
  EXPECT_EQ(usable_cores(files()), usable_cores({"none", "none"}));
  EXPECT_EQ(usable_memory(files()), usable_memory({"none", "none"}));
  // the group above holds as well
  write("system/cpu.max", "50000 100000\n");
  write("system/memory.max", "300000000\n");
  EXPECT_EQ(usable_cores(files()), 1);
  EXPECT_EQ(usable_memory(files()), 300'000'000U);
}

TEST_F(ControlGroups, OfVersion1LimitProcessorsAndMemory) {
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
