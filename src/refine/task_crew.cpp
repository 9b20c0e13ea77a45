#include "refine/task_crew.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace retarget {

TaskCrew::TaskCrew(std::vector<Task> tasks, int threads)
    : tasks_(std::move(tasks)), begun_(tasks_.size(), 0), left_(tasks_.size()) {
  const auto wanted = static_cast<std::size_t>(std::max(1, threads));
  while (others_.size() + 1 < std::min(wanted, tasks_.size())) {
    try {
      others_.emplace_back([this] { run(); });
    } catch (const std::system_error&) {
      // without further threads the caller's does it
      break;
    }
  }
}

TaskCrew::~TaskCrew() {
  stop();
  for (std::thread& thread : others_) thread.join();
}

void TaskCrew::release(std::size_t task) {
  const std::lock_guard lock(mutex_);
  --tasks_[task].waits;
  changed_.notify_all();
}

bool TaskCrew::finish() {
  run();
  const std::lock_guard lock(mutex_);
  return left_ == 0;
}

void TaskCrew::stop() {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  changed_.notify_all();
}

bool TaskCrew::stopped() const {
  const std::lock_guard lock(mutex_);
  return stop_;
}

// the first task that can begin; their number: none
std::size_t TaskCrew::next() const {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (begun_[i] == 0 && tasks_[i].waits <= 0) return i;
  }
  return tasks_.size();
}

void TaskCrew::run() {
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
