// Threads that share tasks: order, waiting, stopping.

#include "solve/fit/task_graph.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>

namespace retarget {
namespace {

TEST(TaskGraph, RunsEveryTaskOnceForAnyThreadCount) {
  for (const int threads : {0, 1, 2, 3, 7, 100}) {
    std::vector<std::atomic<int>> done(20);
    std::vector<TaskGraph::Task> tasks;
    tasks.reserve(done.size());
    for (std::atomic<int>& count : done) tasks.push_back({[&count] { ++count; }});
    TaskGraph crew(std::move(tasks), threads);
    EXPECT_TRUE(crew.finish());
    for (const std::atomic<int>& count : done) EXPECT_EQ(count, 1) << threads;
  }
}

TEST(TaskGraph, HandlesNoTasks) {
  EXPECT_TRUE(TaskGraph({}, 3).finish());
}

TEST(TaskGraph, RespectsDependencies) {
  for (const int threads : {1, 2, 5}) {
    std::atomic<int> before = 0, seen = -1;
    std::vector<TaskGraph::Task> tasks(4);
    tasks[0] = {[&] { seen = before.load(); }, 3};
    for (std::size_t i = 1; i < 4; ++i) tasks[i] = {[&] { ++before; }, 0, {0}};
    TaskGraph crew(std::move(tasks), threads);
    EXPECT_TRUE(crew.finish());
    EXPECT_EQ(seen, 3);
  }
}

TEST(TaskGraph, WorksInTheBackground) {
  std::promise<void> done;
  TaskGraph crew({{[&] { done.set_value(); }, 1}, {[] {}, 1}}, 2);
  auto is_done = done.get_future();
  EXPECT_EQ(is_done.wait_for(std::chrono::milliseconds(5)), std::future_status::timeout);
  crew.release(0);
  EXPECT_EQ(is_done.wait_for(std::chrono::seconds(60)), std::future_status::ready);
  crew.release(1);
  EXPECT_TRUE(crew.finish());
}

TEST(TaskGraph, StoppedWorkersStartNoTask) {
  for (const int threads : {1, 3}) {
    std::atomic<int> done = 0;
    std::vector<TaskGraph::Task> tasks(5);
    tasks[0] = {[&] { ++done; }, 1};
    for (std::size_t i = 1; i < 5; ++i) tasks[i] = {[&] { ++done; }, 1};
    TaskGraph crew(std::move(tasks), threads);
    crew.stop();
    for (std::size_t i = 0; i < 5; ++i) crew.release(i);
    EXPECT_TRUE(crew.stopped());
    EXPECT_FALSE(crew.finish());
    EXPECT_EQ(done, 0);
  }
}

}  // namespace
}  // namespace retarget
