#include "solve/fit/task_graph.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace retarget {

TaskGraph::TaskGraph(std::vector<Task> tasks, int threads)
    : tasks_(std::move(tasks)), begun_(tasks_.size(), 0), left_(tasks_.size()) {
  const auto wanted = static_cast<std::size_t>(std::max(1, threads));
  while (others_.size() + 1 < std::min(wanted, tasks_.size())) {
    try {
      others_.emplace_back([this] { run(); });
    } catch (const std::system_error&) {
      // The system provides no further thread. The existing threads and the caller's run the tasks.
      break;
    }
  }
}

TaskGraph::~TaskGraph() {
  stop();
  for (std::thread& thread : others_) thread.join();
}

void TaskGraph::release(std::size_t task) {
  const std::lock_guard lock(mutex_);
  --tasks_[task].waits;
  changed_.notify_all();
}

bool TaskGraph::finish() {
  run();
  const std::lock_guard lock(mutex_);
  return left_ == 0;
}

void TaskGraph::stop() {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  changed_.notify_all();
}

bool TaskGraph::stopped() const {
  const std::lock_guard lock(mutex_);
  return stop_;
}

// @return the first task that can start; the number of tasks if no task can.
std::size_t TaskGraph::next() const {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (begun_[i] == 0 && tasks_[i].waits <= 0) return i;
  }
  return tasks_.size();
}

void TaskGraph::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return stop_ || left_ == 0 || next() < tasks_.size(); });
    if (stop_ || left_ == 0) return;
    const std::size_t task = next();
    begun_[task] = 1;
    lock.unlock();
    tasks_[task].work();
    lock.lock();
    --left_;
    for (const std::size_t after : tasks_[task].then) --tasks_[after].waits;
    changed_.notify_all();
  }
}

}  // namespace retarget
