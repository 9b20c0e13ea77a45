#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
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
  /// busy processes get one SIGTERM, which asks them to finish quickly.
  std::function<bool()> keep_going;
};

/// Result of a task.
struct TaskEnd {
  bool answered = false;   ///< Whether the process finished the task.
  std::string answer;      ///< Result of the task.
  bool timed_out = false;  ///< The task exceeded its time limit.
  int signal = 0;          ///< Signal that ended the process; 0: it exited by itself.
  std::string signal_name;
  bool was_killed = false;  ///< By SIGKILL, which the system sends when memory runs out.
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
/// Windows cannot fork: there the tasks run on threads of this process. A crash ends all of them,
/// memory has no limit, and task_deadline() tells a task when it must end.
/// Errors (kRun): no process could be created.
[[nodiscard]] Result<void> run_in_processes(
    std::span<const std::uint64_t> memory, const ProcessPoolOptions& options,
    const std::function<std::string(std::size_t task)>& work,
    const std::function<void(std::size_t task, const TaskEnd& end)>& ended);

/// Deadline of the calling thread's task; empty if there is none or another process ends it.
[[nodiscard]] std::optional<std::chrono::steady_clock::time_point> task_deadline();

}  // namespace retarget
