#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace retarget {

struct WorkerPoolOptions {
  int workers = 1;
  std::uint64_t memory = 0;  ///< Bytes that tasks may need together; 0: no bound.
  /// Asked on the caller's thread, ten times a second while tasks run; false: no further task
  /// begins.
  std::function<bool()> keep_going;
};

/// Does tasks 0, 1, ... on several threads, each task on one of them, in this order but for what
/// memory holds up: where the next task does not fit beside those that run, the first that does
/// goes before it; a task that needs more than there is runs alone.
/// @param memory  bytes that each task needs, roughly.
/// @param work    does a task; may be called on several threads at once and must not throw.
void run_tasks(std::span<const std::uint64_t> memory, const WorkerPoolOptions& options,
               const std::function<void(std::size_t task)>& work);

/// Where the system tells of control groups.
struct ControlGroupFiles {
  std::string root = "/sys/fs/cgroup";
  std::string membership = "/proc/self/cgroup";  ///< The groups that this process is in.
};

/// The processors that this process may use: the machine's, fewer where its affinity or the time
/// of its control group (both versions), rounded up, leave fewer.
[[nodiscard]] int usable_cores(const ControlGroupFiles& files = {});

/// The memory that this process may use, bytes: the machine's, or less where its control group has
/// a limit. 0: not known.
[[nodiscard]] std::uint64_t usable_memory(const ControlGroupFiles& files = {});

}  // namespace retarget
