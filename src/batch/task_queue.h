#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <list>
#include <span>

namespace retarget {

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
