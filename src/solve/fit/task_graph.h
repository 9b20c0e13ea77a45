#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace retarget {

/// Runs tasks with dependencies on several threads. The assignment of tasks to threads and the
/// order of independent tasks are unspecified, so tasks that may run concurrently must not share
/// data.
class TaskGraph {
 public:
  struct Task {
    std::function<void()> work;
    int waits = 0;                       ///< Number of releases before the task may start.
    std::vector<std::size_t> then = {};  ///< Tasks that this task releases when it finishes.
  };

  /// Starts tasks immediately, on all threads except the caller's.
  /// @param threads  number of threads including the caller's. The graph uses fewer if the system
  ///     provides no more.
  TaskGraph(std::vector<Task> tasks, int threads);
  /// Calls stop() and waits for the threads.
  ~TaskGraph();
  TaskGraph(const TaskGraph&) = delete;
  TaskGraph& operator=(const TaskGraph&) = delete;

  /// Decrements the number of releases for which a task waits.
  void release(std::size_t task);
  /// Also runs tasks on the caller's thread, until all are finished or the graph is stopped.
  /// @return true if all tasks are finished.
  bool finish();
  /// Prevents any further task from starting.
  void stop();
  [[nodiscard]] bool stopped() const;

 private:
  void run();
  [[nodiscard]] std::size_t next() const;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Task> tasks_;
  std::vector<char> begun_;
  std::size_t left_;
  bool stop_ = false;
  std::vector<std::thread> others_;
};

}  // namespace retarget
