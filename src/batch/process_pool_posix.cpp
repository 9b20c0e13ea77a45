#include "batch/process_pool.h"

#include <poll.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "batch/sanitizer.h"
#include "batch/task_queue.h"
#include "batch/worker_process.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPauseMs = 100;

// Sanitizers reserve more address space than any limit allows.
constexpr bool kBoundsMemory = !kUnderSanitizer;

void bound_memory(std::uint64_t max) {
  if (!kBoundsMemory || max == 0) return;
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY
                       ? static_cast<rlim_t>(max)
                       : std::min(static_cast<rlim_t>(max), limit.rlim_max);
  // If the system does not support the limit, its own out-of-memory handling applies.
  [[maybe_unused]] const int set = ::setrlimit(RLIMIT_DATA, &limit);
}

// A process and its current task.
struct Slot {
  std::optional<WorkerProcess> process;
  std::optional<std::size_t> task;
  Clock::time_point begin;
  bool ended_by_us = false;
};

class Pool {
 public:
  Pool(std::span<const std::uint64_t> memory, const ProcessPoolOptions& options,
       const std::function<std::string(std::size_t)>& work,
       const std::function<void(std::size_t, const TaskEnd&)>& ended)
      : tasks_(memory, options.memory), options_(options), work_(work), ended_(ended) {
    const auto workers = static_cast<std::size_t>(std::max(1, options.workers));
    slots_.resize(std::min(workers, memory.size()));
  }

  Result<void> run() {
    for (;;) {
      for (Slot& slot : slots_) {
        if (slot.task) continue;
        if (auto fed = feed(slot); !fed && tasks_.running() == 0) return fed;
      }
      if (tasks_.running() == 0) return {};
      wait_for_answers();
      end_late_ones();
      ask_whether_to_go_on();
    }
  }

 private:
  Result<void> feed(Slot& slot) {
    const auto next = tasks_.next();
    if (next == tasks_.none()) return {};
    // An idle process may have ended, so try a second time.
    for (int tries = 0; tries < 2; ++tries) {
      if (!slot.process) {
        const auto begin = [&] {
          bound_memory(options_.max_memory);
          if (options_.begin_worker) options_.begin_worker();
        };
        RETARGET_TRY_ASSIGN(auto started,
                            WorkerProcess::start({options_.end_process, begin, work_}));
        slot.process.emplace(std::move(started));
      }
      if (!slot.process->give(*next)) {
        slot.process.reset();
        continue;
      }
      slot.task = tasks_.begin(next);
      slot.begin = Clock::now();
      slot.ended_by_us = false;
      return {};
    }
    return run_failure("", "worker processes exit immediately after start");
  }

  void wait_for_answers() {
    std::vector<pollfd> polled;
    std::vector<Slot*> of;
    for (Slot& slot : slots_) {
      if (!slot.task) continue;
      polled.push_back({slot.process->descriptor(), POLLIN, 0});
      of.push_back(&slot);
    }
    if (::poll(polled.data(), polled.size(), kPauseMs) <= 0) return;
    for (std::size_t i = 0; i < polled.size(); ++i) {
      if (polled[i].revents != 0) take(*of[i]);
    }
  }

  void take(Slot& slot) {
    const WorkerProcess::State state = slot.process->read();
    if (state == WorkerProcess::State::kWaiting) return;
    TaskEnd end;
    if (state == WorkerProcess::State::kAnswered) {
      end.answered = true;
      end.answer = slot.process->take_answer();
    } else {
      end.timed_out = slot.ended_by_us;
      end.signal = slot.process->wait();
      end.was_killed = end.signal == SIGKILL;
      if (end.signal != 0) end.signal_name = ::strsignal(end.signal);
      slot.process.reset();
    }
    const std::size_t task = *slot.task;
    slot.task.reset();
    tasks_.end(task);
    // Feed the process before reporting the result. If feeding fails, it is tried again later.
    [[maybe_unused]] const auto fed = feed(slot);
    ended_(task, end);
  }

  void end_late_ones() {
    if (options_.timeout_s <= 0.0) return;
    const auto now = Clock::now();
    for (Slot& slot : slots_) {
      if (!slot.task || slot.ended_by_us) continue;
      if (std::chrono::duration<double>(now - slot.begin).count() < options_.timeout_s) continue;
      slot.ended_by_us = true;
      slot.process->send_signal(SIGKILL);
    }
  }

  void ask_whether_to_go_on() {
    if (stopped_ || !options_.keep_going || options_.keep_going()) return;
    stopped_ = true;
    tasks_.clear();
    for (const Slot& slot : slots_) {
      if (slot.task) slot.process->send_signal(SIGTERM);
    }
  }

  TaskQueue tasks_;
  const ProcessPoolOptions& options_;
  const std::function<std::string(std::size_t)>& work_;
  const std::function<void(std::size_t, const TaskEnd&)>& ended_;
  std::vector<Slot> slots_;
  bool stopped_ = false;
};

}  // namespace

Result<void> run_in_processes(std::span<const std::uint64_t> memory,
                              const ProcessPoolOptions& options,
                              const std::function<std::string(std::size_t)>& work,
                              const std::function<void(std::size_t, const TaskEnd&)>& ended) {
  return Pool(memory, options, work, ended).run();
}

std::optional<Clock::time_point> task_deadline() {
  return std::nullopt;
}

}  // namespace retarget
