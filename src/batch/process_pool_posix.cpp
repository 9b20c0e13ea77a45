#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "batch/process_pool.h"
#include "retarget/error.h"
#include "retarget/option_name.h"
#include "retarget/try.h"

#ifdef __linux__
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

namespace retarget {
namespace {

// A child process that runs tasks for this process.
class WorkerProcess {
 public:
  // Functions called in the child process.
  struct Actions {
    void (*end)(int code);                         // Ends the process like _exit().
    std::function<void()> begin;                   // Called first.
    std::function<std::string(std::size_t)> work;  // Called for every task.
  };
  [[nodiscard]] static Result<WorkerProcess> start(const Actions& actions);
  ~WorkerProcess();
  WorkerProcess(WorkerProcess&& other) noexcept;
  WorkerProcess& operator=(WorkerProcess&&) = delete;
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  // Sends a task. Returns false if the process has ended.
  [[nodiscard]] bool give(std::size_t task);
  // Reads the available part of an answer. Call it when the descriptor is readable.
  enum class State { kWaiting, kAnswered, kEnded };
  [[nodiscard]] State read();
  [[nodiscard]] std::string take_answer();
  [[nodiscard]] int descriptor() const { return from_worker_; }
  void send_signal(int signal_number) const;
  // Waits for the process to end. Returns the signal that ended it, or 0.
  int wait();

 private:
  WorkerProcess(pid_t id, int to_worker, int from_worker)
      : id_(id), to_worker_(to_worker), from_worker_(from_worker) {}

  pid_t id_;
  int to_worker_, from_worker_;
  std::string received_;
};

// Returns false if the other end is closed.
bool write_all(int descriptor, const void* bytes, std::size_t size) {
  const char* at = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t count = ::write(descriptor, at, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool read_all(int descriptor, void* bytes, std::size_t size) {
  char* at = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t count = ::read(descriptor, at, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

// Programs that the process starts do not inherit it.
int make_pipe(std::array<int, 2>& ends) {
#ifdef __APPLE__
  if (::pipe(ends.data()) != 0) return -1;
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  return 0;
#else
  return ::pipe2(ends.data(), O_CLOEXEC);
#endif
}

// Closes the parent's locks, manifests and pipes, which must not stay open after the parent ends.
void close_all_from(int first) {
#ifdef SYS_close_range
  if (::syscall(SYS_close_range, static_cast<unsigned>(first), ~0U, 0U) == 0) return;
#endif
  const long max = ::sysconf(_SC_OPEN_MAX);
  for (int descriptor = first; descriptor < max; ++descriptor) ::close(descriptor);
}

constexpr int kTasks = 3, kAnswers = 4, kOthers = 5;

// While alive, holds back SIGTERM, so that a new process gets it only after it has its own handler.
class HeldTermination {
 public:
  HeldTermination() {
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGTERM);
    ::sigprocmask(SIG_BLOCK, &held, &before_);
  }
  ~HeldTermination() { release(); }
  HeldTermination(const HeldTermination&) = delete;
  HeldTermination& operator=(const HeldTermination&) = delete;

  void release() const { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

// Runs tasks until the pipe closes. Returns false if it could not start.
bool serve(pid_t parent, int tasks, int answers, const WorkerProcess::Actions& actions,
           const HeldTermination& held) {
  // Move both descriptors away from the numbers that they will be duplicated to.
  const int other_tasks = ::fcntl(tasks, F_DUPFD, kOthers);
  const int other_answers = ::fcntl(answers, F_DUPFD, kOthers);
  if (::dup2(other_tasks, kTasks) < 0 || ::dup2(other_answers, kAnswers) < 0) return false;
  close_all_from(kOthers);
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  // The parent may have ended before prctl() took effect.
  if (::getppid() != parent) return false;
  if (actions.begin) actions.begin();
  held.release();
  std::uint64_t task = 0;
  while (read_all(kTasks, &task, sizeof task)) {
    const std::string answer = actions.work(static_cast<std::size_t>(task));
    const std::uint64_t size = answer.size();
    if (!write_all(kAnswers, &size, sizeof size)) break;
    if (!write_all(kAnswers, answer.data(), answer.size())) break;
  }
  return true;
}

Failure start_failure(int error_number) {
  return run_failure("", "cannot start a process: " + std::generic_category().message(error_number),
                     "fewer " RETARGET_OPTION("jobs") " need fewer processes");
}

Result<WorkerProcess> WorkerProcess::start(const Actions& actions) {
  std::array<int, 2> tasks{}, answers{};
  if (make_pipe(tasks) != 0) return start_failure(errno);
  if (make_pipe(answers) != 0) {
    const int error_number = errno;
    for (const int end : tasks) ::close(end);
    return start_failure(error_number);
  }
  const pid_t parent = ::getpid();
  const HeldTermination held;
  const pid_t id = ::fork();
  const int error_number = errno;
  if (id == 0) {
    // Never return into the caller or destroy the parent's objects in the child.
    actions.end(serve(parent, tasks[0], answers[1], actions, held) ? 0 : 1);
    for (;;) ::pause();
  }
  ::close(tasks[0]);
  ::close(answers[1]);
  if (id > 0) return WorkerProcess(id, tasks[1], answers[0]);
  ::close(tasks[1]);
  ::close(answers[0]);
  return start_failure(error_number);
}

WorkerProcess::~WorkerProcess() {
  if (id_ > 0) wait();
}

WorkerProcess::WorkerProcess(WorkerProcess&& other) noexcept
    : id_(std::exchange(other.id_, -1)),
      to_worker_(std::exchange(other.to_worker_, -1)),
      from_worker_(std::exchange(other.from_worker_, -1)),
      received_(std::move(other.received_)) {}

bool WorkerProcess::give(std::size_t task) {
  const std::uint64_t number = task;
  return write_all(to_worker_, &number, sizeof number);
}

WorkerProcess::State WorkerProcess::read() {
  std::array<char, 65536> bytes{};
  const ssize_t count = ::read(from_worker_, bytes.data(), bytes.size());
  if (count < 0) return errno == EINTR ? State::kWaiting : State::kEnded;
  if (count == 0) return State::kEnded;
  received_.append(bytes.data(), static_cast<std::size_t>(count));
  std::uint64_t size = 0;
  if (received_.size() < sizeof size) return State::kWaiting;
  std::memcpy(&size, received_.data(), sizeof size);
  return received_.size() - sizeof size < size ? State::kWaiting : State::kAnswered;
}

std::string WorkerProcess::take_answer() {
  std::string answer = std::exchange(received_, {});
  answer.erase(0, sizeof(std::uint64_t));
  return answer;
}

void WorkerProcess::send_signal(int signal_number) const {
  if (id_ > 0) ::kill(id_, signal_number);
}

int WorkerProcess::wait() {
  // The child exits when its task pipe is closed.
  if (to_worker_ >= 0) ::close(std::exchange(to_worker_, -1));
  if (from_worker_ >= 0) ::close(std::exchange(from_worker_, -1));
  int status = 0;
  while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

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
      end.was_killed = end.signal == SIGKILL || end.signal == SIGTERM;
      if (end.signal != 0) end.signal_name = ::strsignal(end.signal);
      slot.process.reset();
    }
    const std::size_t task = *slot.task;
    slot.task.reset();
    tasks_.end(task);
    if (end.signal == SIGTERM) wait_for_own_signal();
    // Feed the process before reporting the result. If feeding fails, it is tried again later.
    [[maybe_unused]] const auto fed = feed(slot);
    ended_(task, end);
  }

  // A signal to all processes of the batch, one by one, may reach this one last. Then its tasks did
  // not fail, and no further one should start.
  void wait_for_own_signal() {
    if (stopped_) return;
    ::poll(nullptr, 0, kPauseMs);
    ask_whether_to_go_on();
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
