#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <string>

#include "retarget/error.h"

namespace retarget {

/// A child process that runs tasks for this process.
class WorkerProcess {
 public:
  /// Functions called in the child process.
  struct Actions {
    void (*end)(int code);                         ///< Ends the process like _exit().
    std::function<void()> begin;                   ///< Called first.
    std::function<std::string(std::size_t)> work;  ///< Called for every task.
  };
  [[nodiscard]] static Result<WorkerProcess> start(const Actions& actions);
  ~WorkerProcess();
  WorkerProcess(WorkerProcess&& other) noexcept;
  WorkerProcess& operator=(WorkerProcess&&) = delete;
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// Sends a task. Returns false if the process has ended.
  [[nodiscard]] bool give(std::size_t task);
  /// Reads the available part of an answer. Call it when the descriptor is readable.
  enum class State { kWaiting, kAnswered, kEnded };
  [[nodiscard]] State read();
  [[nodiscard]] std::string take_answer();
  [[nodiscard]] int descriptor() const { return from_worker_; }
  void send_signal(int signal_number) const;
  /// Waits for the process to end. Returns the signal that ended it, or 0.
  int wait();

 private:
  WorkerProcess(pid_t id, int to_worker, int from_worker)
      : id_(id), to_worker_(to_worker), from_worker_(from_worker) {}

  pid_t id_;
  int to_worker_, from_worker_;
  std::string received_;
};

}  // namespace retarget
