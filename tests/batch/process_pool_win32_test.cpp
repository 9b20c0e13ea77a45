// Where processes cannot fork, tasks run on threads.

#include "batch/process_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace retarget {
namespace {

using std::chrono::milliseconds;

std::map<std::size_t, TaskEnd> run_all(std::size_t tasks, const ProcessPoolOptions& options,
                                       const std::function<std::string(std::size_t)>& work) {
  std::map<std::size_t, TaskEnd> ends;
  const std::vector<std::uint64_t> memory(tasks, 10);
  const auto main_thread = std::this_thread::get_id();
  const auto ran = run_in_processes(memory, options, work, [&](std::size_t i, const TaskEnd& end) {
    EXPECT_EQ(std::this_thread::get_id(), main_thread);
    ends[i] = end;
  });
  EXPECT_TRUE(ran.has_value());
  return ends;
}

TEST(ProcessPool, RunsEveryTaskOnce) {
  for (const int workers : {1, 2, 7}) {
    ProcessPoolOptions options;
    options.workers = workers;
    const auto ends = run_all(20, options, [](std::size_t i) { return std::to_string(i); });
    ASSERT_EQ(ends.size(), 20U);
    for (const auto& [task, end] : ends) {
      EXPECT_TRUE(end.answered);
      EXPECT_EQ(end.answer, std::to_string(task));
    }
  }
  EXPECT_TRUE(run_all(0, {}, {}).empty());
}

TEST(ProcessPool, StaysWithinItsMemoryLimit) {
  ProcessPoolOptions options;
  options.workers = 8;
  options.memory = 25;
  std::atomic<int> running = 0, most = 0;
  run_all(12, options, [&](std::size_t) {
    const int now = ++running;
    for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
    }
    std::this_thread::sleep_for(milliseconds(5));
    --running;
    return std::string("done");
  });
  EXPECT_EQ(most, 2);
}

TEST(ProcessPool, PassesTheDeadlineToTheTask) {
  ProcessPoolOptions options;
  options.workers = 2;
  options.timeout_s = 0.1;
  const auto ends = run_all(3, options, [](std::size_t i) {
    const auto deadline = task_deadline();
    EXPECT_TRUE(deadline.has_value());
    if (i != 1) return std::string("quick");
    while (std::chrono::steady_clock::now() < *deadline)
      std::this_thread::sleep_for(milliseconds(5));
    return std::string();
  });
  EXPECT_TRUE(ends.at(0).answered && ends.at(2).answered);
  EXPECT_FALSE(ends.at(1).answered);
  EXPECT_TRUE(ends.at(1).timed_out);
  EXPECT_FALSE(task_deadline().has_value());
}

TEST(ProcessPool, StartsNoTaskAfterAStop) {
  ProcessPoolOptions options;
  options.workers = 2;
  std::atomic<int> begun = 0;
  options.keep_going = [&] { return begun < 4; };
  const auto ends = run_all(1000, options, [&](std::size_t) {
    ++begun;
    std::this_thread::sleep_for(milliseconds(20));
    return std::string("done");
  });
  EXPECT_LT(begun, 20);
  EXPECT_EQ(static_cast<int>(ends.size()), begun);
}

}  // namespace
}  // namespace retarget
