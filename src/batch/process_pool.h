#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <span>
#include <string>

#include "retarget/error.h"

namespace retarget {

struct ProcessPoolOptions {
  int workers = 1;
  std::uint64_t memory = 0;  ///< Bytes that running tasks may need together; 0: unlimited.
  /// Bytes per process; further allocations fail. 0: unlimited.
  std::uint64_t max_memory = 0;
  double timeout_s = 0.0;  ///< Time limit per task, after which its process is killed; 0: none.
  /// Ends a pool process immediately without destroying the objects it copied: _exit(). The caller
  /// must provide it, because the library never ends a process by itself.
  void (*end_process)(int code) = nullptr;
  /// Called first in every worker process.
  std::function<void()> begin_worker;
  /// Polled ten times per second while tasks run. When it returns false, no further task begins and
  /// busy processes get one SIGTERM from this process, which asks them to finish quickly.
  std::function<bool()> keep_going;
};

/// Result of a task.
struct TaskEnd {
  bool answered = false;   ///< Whether the process finished the task.
  std::string answer;      ///< Result of the task.
  bool timed_out = false;  ///< The task exceeded its time limit.
  int signal = 0;          ///< Signal that ended the process; 0: it exited by itself.
  std::string signal_name;
  /// True if SIGKILL or SIGTERM ended it, which the system and its daemons send when memory runs
  /// out.
  bool was_killed = false;
};

/// Runs tasks 0, 1, ... in several processes, one task per process at a time. Tasks start in order
/// unless memory is short: if the next task does not fit, the first one that fits is started. A
/// task that needs more than the limit runs alone.
///
/// Processes are forked from this one, and forked again if a task ends one of them, so the caller
/// must have no other threads. They keep no open files except the standard streams, and end with
/// this process, however it ends.
/// @param memory  estimated bytes per task.
/// @param work    runs a task, in a process of the pool; must not throw.
/// @param ended   called in this process, sequentially, for every task that began.
/// Windows cannot fork, so there the tasks run on threads of this process. A crash ends all of
/// them, memory has no limit, and tasks read their deadline from task_deadline().
/// Errors (kRun): no process could be created.
[[nodiscard]] Result<void> run_in_processes(
    std::span<const std::uint64_t> memory, const ProcessPoolOptions& options,
    const std::function<std::string(std::size_t task)>& work,
    const std::function<void(std::size_t task, const TaskEnd& end)>& ended);

/// Deadline of the calling thread's task; empty if there is none or another process ends it.
[[nodiscard]] std::optional<std::chrono::steady_clock::time_point> task_deadline();

// clang does not define GCC's __SANITIZE_* macros.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RETARGET_UNDER_SANITIZER 1
#endif
#endif

/// Whether the build uses the address or thread sanitizer of GCC or clang.
#if defined(RETARGET_UNDER_SANITIZER) || defined(__SANITIZE_ADDRESS__) || \
    defined(__SANITIZE_THREAD__)
inline constexpr bool kUnderSanitizer = true;
#else
inline constexpr bool kUnderSanitizer = false;
#endif

/// The tasks of a pool in their order, with the memory that they need. Not synchronised.
class TaskQueue {
 public:
  using Task = std::list<std::size_t>::const_iterator;

  /// @param memory  estimated bytes per task; kept as a reference.
  /// @param limit   bytes that running tasks may need together; 0: unlimited.
  TaskQueue(std::span<const std::uint64_t> memory, std::uint64_t limit)
      : memory_(memory), limit_(limit) {
    for (std::size_t task = 0; task < memory.size(); ++task) waiting_.push_back(task);
  }

  /// The first task that fits next to the running ones; none(): no task fits.
  [[nodiscard]] Task next() const {
    return std::ranges::find_if(waiting_, [&](std::size_t task) {
      return running_ == 0 || limit_ == 0 || used_ + memory_[task] <= limit_;
    });
  }
  [[nodiscard]] Task none() const { return waiting_.end(); }
  [[nodiscard]] bool is_empty() const { return waiting_.empty(); }
  [[nodiscard]] std::size_t running() const { return running_; }

  /// Moves a task from the waiting to the running ones. @return its number.
  std::size_t begin(Task next) {
    const std::size_t task = *next;
    waiting_.erase(next);
    ++running_;
    used_ += memory_[task];
    return task;
  }
  void end(std::size_t task) {
    --running_;
    used_ -= memory_[task];
  }
  /// Drops all waiting tasks.
  void clear() { waiting_.clear(); }

 private:
  std::span<const std::uint64_t> memory_;
  std::uint64_t limit_;
  std::list<std::size_t> waiting_;
  std::size_t running_ = 0;
  std::uint64_t used_ = 0;
};

}  // namespace retarget
