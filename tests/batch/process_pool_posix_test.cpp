#include "batch/process_pool.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <new>
#include <string>
#include <thread>
#include <vector>

namespace retarget {
namespace {

using ::testing::ElementsAre;

using Ends = std::map<std::size_t, TaskEnd>;

Ends ends_of(const std::vector<std::uint64_t>& memory, const ProcessPoolOptions& options,
             const std::function<std::string(std::size_t)>& work) {
  Ends ends;
  const auto ran = run_in_processes(memory, options, work, [&](std::size_t task, const TaskEnd& e) {
    EXPECT_TRUE(ends.emplace(task, e).second) << task << " ended twice";
  });
  EXPECT_TRUE(ran.has_value());
  return ends;
}

ProcessPoolOptions with_exit() {
  ProcessPoolOptions options;
  options.end_process = ::_exit;
  return options;
}

void sleep_ms(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

TEST(ProcessPool, RunsEveryTaskOnceForAnyWorkerCount) {
  for (const int workers : {0, 1, 3, 16}) {
    ProcessPoolOptions options = with_exit();
    options.workers = workers;
    // Answers longer than a pipe buffer, and empty ones.
    const auto ends = ends_of(std::vector<std::uint64_t>(50, 1), options, [](std::size_t task) {
      return std::string(task % 7 == 0 ? 300'000 : task % 3, static_cast<char>('a' + task % 26));
    });
    ASSERT_EQ(ends.size(), 50U);
    for (const auto& [task, end] : ends) {
      EXPECT_TRUE(end.answered);
      EXPECT_EQ(end.answer, std::string(task % 7 == 0 ? 300'000 : task % 3,
                                        static_cast<char>('a' + task % 26)));
    }
  }
}

TEST(ProcessPool, HandlesNoTasks) {
  EXPECT_TRUE(ends_of({}, {}, [](std::size_t) { return std::string(); }).empty());
}

TEST(ProcessPool, OneWorkerKeepsOrderAndProcess) {
  std::vector<std::size_t> order;
  std::vector<std::string> processes;
  const std::vector<std::uint64_t> memory = {5, 1, 9, 2};
  ProcessPoolOptions options = with_exit();
  options.memory = 3;
  const auto ran = run_in_processes(
      memory, options, [](std::size_t) { return std::to_string(::getpid()); },
      [&](std::size_t task, const TaskEnd& end) {
        order.push_back(task);
        processes.push_back(end.answer);
      });
  ASSERT_TRUE(ran);
  EXPECT_THAT(order, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(std::ranges::count(processes, processes.front()), 4);
  EXPECT_NE(processes.front(), std::to_string(::getpid()));
}

TEST(ProcessPool, RunningTasksStayBelowTheMemoryLimit) {
  // The first task exceeds the limit and runs alone.
  const std::vector<std::uint64_t> memory = {50, 8, 8, 8, 1, 1, 1, 8, 2, 7};
  ProcessPoolOptions options = with_exit();
  options.workers = 8;
  options.memory = 10;
  const auto now = [] {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::microseconds(1);
  };
  const auto ends = ends_of(memory, options, [&](std::size_t) {
    const auto begin = now();
    sleep_ms(10);
    return std::to_string(begin) + " " + std::to_string(now());
  });
  std::vector<std::pair<long, long>> spans(memory.size());
  for (const auto& [task, end] : ends) {
    char* rest = nullptr;
    spans[task].first = std::strtol(end.answer.c_str(), &rest, 10);
    spans[task].second = std::strtol(rest, nullptr, 10);
  }
  for (std::size_t a = 0; a < spans.size(); ++a) {
    std::uint64_t used = 0;
    for (std::size_t b = 0; b < spans.size(); ++b) {
      if (spans[b].first <= spans[a].first && spans[a].first < spans[b].second) used += memory[b];
    }
    EXPECT_LE(used, a == 0 ? 50U : 10U) << a;
  }
}

TEST(ProcessPool, ReportsACrashAndContinues) {
  ProcessPoolOptions options = with_exit();
  options.workers = 2;
  const auto ends = ends_of(std::vector<std::uint64_t>(12, 1), options, [](std::size_t task) {
    if (task == 2) ::raise(SIGKILL);
    if (task == 3) ::_exit(7);
    if (task == 5) std::abort();
    return std::string("done");
  });
  ASSERT_EQ(ends.size(), 12U);
  for (const auto& [task, end] : ends) {
    const bool ended = task == 2 || task == 3 || task == 5;
    EXPECT_EQ(end.answered, !ended) << task;
    EXPECT_FALSE(end.timed_out);
    EXPECT_EQ(end.signal, task == 2 ? SIGKILL : task == 5 ? SIGABRT : 0) << task;
  }
}

TEST(ProcessPool, TerminatingAWorkerFailsOnlyItsTask) {
  ProcessPoolOptions options = with_exit();
  options.keep_going = [] { return true; };
  const auto ends = ends_of({1, 1, 1}, options, [](std::size_t task) {
    if (task == 1) ::raise(SIGTERM);
    return std::string("done");
  });
  ASSERT_EQ(ends.size(), 3U);
  for (const auto& [task, end] : ends) {
    EXPECT_EQ(end.answered, task != 1);
    EXPECT_EQ(end.was_killed, task == 1);
  }
}

TEST(ProcessPool, ASignalToAllProcessesMayReachTheWorkerFirst) {
  ProcessPoolOptions options = with_exit();
  const auto begin = std::chrono::steady_clock::now();
  options.keep_going = [&] {
    return std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(50);
  };
  const auto ends = ends_of({1, 1, 1}, options, [](std::size_t) {
    ::raise(SIGTERM);
    return std::string("done");
  });
  EXPECT_EQ(ends.size(), 1U);
}

TEST(ProcessPool, KillsAHangingTask) {
  ProcessPoolOptions options = with_exit();
  options.workers = 2;
  options.timeout_s = 0.3;
  const auto begin = std::chrono::steady_clock::now();
  const auto ends = ends_of(std::vector<std::uint64_t>(6, 1), options, [](std::size_t task) {
    for (volatile bool forever = task == 1; forever;) sleep_ms(1);
    return std::string("done");
  });
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  ASSERT_EQ(ends.size(), 6U);
  for (const auto& [task, end] : ends) {
    EXPECT_EQ(end.timed_out, task == 1);
    EXPECT_EQ(end.answered, task != 1);
  }
}

TEST(ProcessPool, LimitsMemoryOfATask) {
  if (kUnderSanitizer) GTEST_SKIP() << "sanitizers take address space beyond any bound";
  ProcessPoolOptions options = with_exit();
  options.max_memory = std::uint64_t{256} << 20U;
  const auto ends = ends_of({1, 1}, options, [](std::size_t task) -> std::string {
    try {
      const std::string large(task == 0 ? std::size_t{1} << 30U : std::size_t{1} << 20U, 'x');
      return large.substr(0, 2);
    } catch (const std::bad_alloc&) {
      return "refused";
    }
  });
  EXPECT_EQ(ends.at(0).answer, "refused");
  EXPECT_EQ(ends.at(1).answer, "xx");
}

TEST(ProcessPool, WorkersCloseInheritedFiles) {
  const int descriptor = ::open("/dev/null", O_RDONLY);
  ASSERT_GT(descriptor, 2);
  ProcessPoolOptions options = with_exit();
  options.workers = 3;
  const auto ends = ends_of(std::vector<std::uint64_t>(9, 1), options, [](std::size_t) {
    int open = 0;
    for (int i = 3; i < 1000; ++i) open += ::fcntl(i, F_GETFD) >= 0 ? 1 : 0;
    return std::to_string(open);
  });
  ::close(descriptor);
  for (const auto& [task, end] : ends) EXPECT_EQ(end.answer, "2");  // its two pipes
}

volatile std::sig_atomic_t told = 0;

TEST(ProcessPool, StartsNoTaskAfterStop) {
  ProcessPoolOptions options = with_exit();
  options.workers = 2;
  options.begin_worker = [] { std::signal(SIGTERM, [](int) { told = 1; }); };
  int asked = 0;
  options.keep_going = [&] { return ++asked < 2; };
  const auto ends = ends_of(std::vector<std::uint64_t>(100, 1), options, [](std::size_t) {
    for (int i = 0; i < 10'000 && told == 0; ++i) sleep_ms(1);
    return std::string(told != 0 ? "quick" : "late");
  });
  EXPECT_EQ(ends.size(), 2U);
  for (const auto& [task, end] : ends) EXPECT_EQ(end.answer, "quick");
}

}  // namespace
}  // namespace retarget
