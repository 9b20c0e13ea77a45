#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "retarget/error.h"

namespace retarget {

struct ProcessPoolOptions {
  int workers = 1;
  std::uint64_t memory = 0;  ///< Bytes that tasks may need together; 0: no bound.
  /// Bytes that one process may take: beyond them allocation fails in it; 0: no bound.
  std::uint64_t max_memory = 0;
  double timeout_s = 0.0;  ///< A task that takes longer is ended with its process; 0: none is.
  /// Ends a process of the pool at once, taking down none of the objects that it has copies of: _exit().
  /// It must be given, since the library ends no process of its own accord.
  void (*end_process)(int code) = nullptr;
  /// Called first in every process that does tasks.
  std::function<void()> begin_worker;
  /// Asked ten times a second while tasks run; false: no further task begins, and the processes that
  /// do one get SIGTERM, once, which they may take as a wish to be quick.
  std::function<bool()> keep_going;
};

/// What came of a task.
struct TaskEnd {
  bool answered = false;   ///< Else its process ended before it was through:
  std::string answer;      ///< what the task gave;
  bool timed_out = false;  ///< it took too long,
  int signal = 0;          ///< a signal ended it; 0: it left by itself.
};

/// Does tasks 0, 1, ... in several processes, each task in one of them, in this order but for what
/// memory holds up: where the next task does not fit beside those that run, the first that does
/// goes before it; a task that needs more than there is runs alone.
///
/// The processes are copies of this one, made by fork() and made again when one ends over a task, so
/// the caller must have no other threads. They hold none of its files but the standard streams, and end
/// with it, however it ends.
/// @param memory  bytes that each task needs, roughly.
/// @param work    does a task, in a process of the pool; must not throw.
/// @param ended   is told of every task that began, here, one after the other.
/// Errors (kRun): no process could be made.
[[nodiscard]] Result<void> run_in_processes(
    std::span<const std::uint64_t> memory, const ProcessPoolOptions& options,
    const std::function<std::string(std::size_t task)>& work,
    const std::function<void(std::size_t task, const TaskEnd& end)>& ended);

}  // namespace retarget
