// Windows has no fork: the tasks run on threads of this process.

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "batch/process_pool.h"
#include "retarget/option_name.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPause = std::chrono::milliseconds(100);

thread_local std::optional<Clock::time_point> deadline_of_thread;

class ThreadPool {
 public:
  ThreadPool(std::span<const std::uint64_t> memory, const ProcessPoolOptions& options,
             const std::function<std::string(std::size_t)>& work,
             const std::function<void(std::size_t, const TaskEnd&)>& ended)
      : task_count_(memory.size()),
        tasks_(memory, options.memory),
        options_(options),
        work_(work),
        ended_(ended) {}

  Result<void> run() {
    const auto workers = static_cast<std::size_t>(std::max(1, options_.workers));
    std::vector<std::thread> threads;
    Result<void> started;
    while (threads.size() < std::min(workers, task_count_)) {
      try {
        threads.emplace_back([this] { serve(); });
      } catch (const std::system_error& error) {
        if (threads.empty()) {
          started = run_failure("", std::string("cannot start a thread: ") + error.what(),
                                "fewer " RETARGET_OPTION("jobs") " need fewer threads");
        }
        break;
      }
    }
    if (started) collect();
    for (std::thread& thread : threads) thread.join();
    return started;
  }

 private:
  // Runs tasks until none remain.
  void serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
      auto next = tasks_.none();
      work_left_.wait(lock, [&] {
        next = tasks_.next();
        return tasks_.is_empty() || next != tasks_.none();
      });
      if (tasks_.is_empty()) return;
      const std::size_t task = tasks_.begin(next);
      lock.unlock();
      TaskEnd end = run_task(task);
      lock.lock();
      tasks_.end(task);
      done_.emplace_back(task, std::move(end));
      work_left_.notify_all();
      task_ended_.notify_all();
    }
  }

  TaskEnd run_task(std::size_t task) {
    deadline_of_thread.reset();
    if (options_.timeout_s > 0.0) {
      deadline_of_thread = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(options_.timeout_s));
    }
    TaskEnd end;
    end.answer = work_(task);
    // A task that ended at its deadline has no answer.
    end.timed_out = end.answer.empty() && deadline_of_thread && Clock::now() >= *deadline_of_thread;
    end.answered = !end.timed_out;
    return end;
  }

  // Reports results on the caller's thread until every task has ended.
  void collect() {
    std::unique_lock lock(mutex_);
    while (!tasks_.is_empty() || tasks_.running() > 0 || !done_.empty()) {
      task_ended_.wait_for(lock, kPause, [&] { return !done_.empty(); });
      std::vector<std::pair<std::size_t, TaskEnd>> done = std::exchange(done_, {});
      lock.unlock();
      for (const auto& [task, end] : done) ended_(task, end);
      const bool goes_on = !options_.keep_going || options_.keep_going();
      lock.lock();
      if (goes_on) continue;
      tasks_.clear();
      work_left_.notify_all();
    }
  }

  std::size_t task_count_;
  TaskQueue tasks_;  // Guarded by mutex_, like done_.
  const ProcessPoolOptions& options_;
  const std::function<std::string(std::size_t)>& work_;
  const std::function<void(std::size_t, const TaskEnd&)>& ended_;
  std::mutex mutex_;
  std::condition_variable work_left_, task_ended_;
  std::vector<std::pair<std::size_t, TaskEnd>> done_;
};

}  // namespace

Result<void> run_in_processes(std::span<const std::uint64_t> memory,
                              const ProcessPoolOptions& options,
                              const std::function<std::string(std::size_t)>& work,
                              const std::function<void(std::size_t, const TaskEnd&)>& ended) {
  return ThreadPool(memory, options, work, ended).run();
}

std::optional<Clock::time_point> task_deadline() {
  return deadline_of_thread;
}

}  // namespace retarget
