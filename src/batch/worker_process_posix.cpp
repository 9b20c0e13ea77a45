#include "batch/worker_process.h"
#include "retarget/option_name.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <utility>

namespace retarget {
namespace {

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

// Runs tasks until the pipe closes. Returns false if it could not start.
bool serve(pid_t parent, int tasks, int answers, const WorkerProcess::Actions& actions) {
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

}  // namespace

Result<WorkerProcess> WorkerProcess::start(const Actions& actions) {
  std::array<int, 2> tasks{}, answers{};
  if (make_pipe(tasks) != 0) return start_failure(errno);
  if (make_pipe(answers) != 0) {
    const int error_number = errno;
    for (const int end : tasks) ::close(end);
    return start_failure(error_number);
  }
  const pid_t parent = ::getpid();
  const pid_t id = ::fork();
  const int error_number = errno;
  if (id == 0) {
    // Never return into the caller or destroy the parent's objects in the child.
    actions.end(serve(parent, tasks[0], answers[1], actions) ? 0 : 1);
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

}  // namespace retarget
