#include "retarget/batch/worker_pool.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "retarget/base/file.h"

namespace retarget {
namespace {

class TaskQueue {
 public:
  TaskQueue(std::span<const std::uint64_t> memory, std::uint64_t most)
      : memory_(memory), most_(most) {
    for (std::size_t task = 0; task < memory.size(); ++task) waiting_.push_back(task);
  }

  /// The next task for a worker, once there is room for one; nothing when all are given away.
  std::optional<std::size_t> take() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (waiting_.empty()) return std::nullopt;
      const auto fits = std::ranges::find_if(waiting_, [&](std::size_t task) {
        return running_ == 0 || most_ == 0 || used_ + memory_[task] <= most_;
      });
      if (fits != waiting_.end()) {
        const std::size_t task = *fits;
        waiting_.erase(fits);
        ++running_;
        used_ += memory_[task];
        return task;
      }
      changed_.wait(lock);
    }
  }

  void finished(std::size_t task) {
    const std::lock_guard lock(mutex_);
    --running_;
    used_ -= memory_[task];
    changed_.notify_all();
  }

  void drop_waiting() {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    changed_.notify_all();
  }

  void worker_left() {
    const std::lock_guard lock(mutex_);
    ++left_;
    changed_.notify_all();
  }

  /// Waits a while; true once so many workers have left.
  bool all_left(std::size_t workers) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::milliseconds(100),
                             [&] { return left_ == workers; });
  }

 private:
  std::span<const std::uint64_t> memory_;
  const std::uint64_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::list<std::size_t> waiting_;
  std::size_t running_ = 0, left_ = 0;
  std::uint64_t used_ = 0;
};

// a file's first word that is a number (`max` and -1, which mean no bound, are none), or a later one
std::optional<std::uint64_t> number_in(const std::string& path, int words_before = 0) {
  const auto file = read_file(path, ErrorKind::kRun);
  if (!file) return std::nullopt;
  std::string_view text = file->view();
  for (; words_before > 0; --words_before) {
    text.remove_prefix(std::min(text.find(' '), text.size()));
    text.remove_prefix(std::min<std::size_t>(1, text.size()));
  }
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

// the folders of the control groups that a process is in, of both versions, by the controller's
// name; groups above come after those below
struct ControlGroup {
  std::string folder;
  bool unified = false;  // version 2
};
std::vector<ControlGroup> control_groups(const std::string& root_of_all,
                                         const std::string& membership,
                                         std::string_view controller) {
  std::vector<ControlGroup> found;
  const auto groups = read_file(membership, ErrorKind::kRun);
  std::string_view text = groups ? groups->view() : std::string_view();
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string line(text.substr(0, length));
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool unified = controllers.empty();
    const std::string wanted = "," + std::string(controller) + ",";
    if (!unified && ("," + controllers + ",").find(wanted) == std::string::npos) continue;
    const std::string root = root_of_all + (unified ? "" : "/" + std::string(controller));
    // a limit of a group above holds as well
    for (std::string group = line.substr(second + 1);; group.erase(group.rfind('/'))) {
      found.push_back({root + (group == "/" ? "" : group), unified});
      if (group.find('/') == std::string::npos) break;
    }
  }
  return found;
}

// how many processors' time a group has: quota over period, nothing where it has no bound
std::optional<double> processors_of(const ControlGroup& group) {
  const std::string two_numbers = group.folder + "/cpu.max";
  const auto quota =
      group.unified ? number_in(two_numbers) : number_in(group.folder + "/cpu.cfs_quota_us");
  const auto period =
      group.unified ? number_in(two_numbers, 1) : number_in(group.folder + "/cpu.cfs_period_us");
  if (!quota || !period || *quota == 0 || *period == 0) return std::nullopt;
  return static_cast<double>(*quota) / static_cast<double>(*period);
}

}  // namespace

void run_tasks(std::span<const std::uint64_t> memory, const WorkerPoolOptions& options,
               const std::function<void(std::size_t)>& work) {
  TaskQueue queue(memory, options.memory);
  const auto run = [&] {
    while (const auto task = queue.take()) {
      work(*task);
      queue.finished(*task);
    }
  };
  const std::size_t wanted =
      std::min<std::size_t>(static_cast<std::size_t>(std::max(1, options.workers)), memory.size());
  std::vector<std::thread> threads;
  try {
    while (threads.size() < wanted) {
      threads.emplace_back([&] {
        run();
        queue.worker_left();
      });
    }
  } catch (const std::system_error&) {
    // fewer threads do it as well
  }
  if (threads.empty()) run();
  while (!threads.empty() && !queue.all_left(threads.size())) {
    if (options.keep_going && !options.keep_going()) queue.drop_waiting();
  }
  for (std::thread& thread : threads) thread.join();
}

int usable_cores(const ControlGroupFiles& files) {
  // threads that share less time than they are only wait for each other
  double least = std::max(1U, std::thread::hardware_concurrency());
  for (const ControlGroup& group : control_groups(files.root, files.membership, "cpu")) {
    if (const auto processors = processors_of(group)) least = std::min(least, *processors);
  }
  return std::max(1, static_cast<int>(std::ceil(least)));
}

std::uint64_t usable_memory(const ControlGroupFiles& files) {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return 0;
  std::uint64_t least = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
  for (const ControlGroup& group : control_groups(files.root, files.membership, "memory")) {
    const auto limit =
        number_in(group.folder + (group.unified ? "/memory.max" : "/memory.limit_in_bytes"));
    if (limit) least = std::min(least, *limit);
  }
  return least;
}

}  // namespace retarget
