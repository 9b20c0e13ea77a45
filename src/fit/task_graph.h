#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace retarget {

/// Tasks that wait for each other and the threads that do them. Which thread does which, and in
/// what order those that wait for nothing come, is left open: tasks at the same time must not touch
/// each other's data.
class TaskGraph {
 public:
  struct Task {
    std::function<void()> work;
    int waits = 0;                       ///< How often it must be released before it may begin.
    std::vector<std::size_t> then = {};  ///< Tasks that are released when this one is done.
  };

  /// Begins at once, with all threads but the caller's.
  /// @param threads  with the caller's; where the system has no further ones, fewer do it.
  TaskGraph(std::vector<Task> tasks, int threads);
  /// As stop(), and waits for the threads.
  ~TaskGraph();
  TaskGraph(const TaskGraph&) = delete;
  TaskGraph& operator=(const TaskGraph&) = delete;

  /// One of the things that a task waits for is there.
  void release(std::size_t task);
  /// The caller's thread takes tasks as well, until all are done or the graph is stopped.
  /// @return whether all are done.
  bool finish();
  /// No task is begun any more.
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
