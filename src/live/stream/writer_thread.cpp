#include "live/stream/writer_thread.h"

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "live/stream/descriptor_write.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kLookAtEnd = milliseconds(50);  // Interval at which waits check for the end.
constexpr auto kWithoutProgress = milliseconds(500), kDiskWithoutProgress = milliseconds(5000);
constexpr auto kSlowAfter = milliseconds(3000);   // For a slow reader.
constexpr auto kLeaveWithin = milliseconds(200);  // For a thread that was stopped.

}  // namespace

bool is_regular_file(const Descriptor& file) {
  return descriptor_kind(file) == DescriptorKind::kFile;
}

struct WriterThread::State {
  State(Descriptor file, FrameBytesQueue::Bounds bounds)
      : to(std::move(file)), kind(descriptor_kind(to)), waiting(bounds) {}

  void run();
  bool write(std::string_view piece);
  void remove_cut_piece(std::size_t written) const;

  const Descriptor to;
  const DescriptorKind kind;

  mutable std::mutex mutex;
  std::condition_variable work, change;  // Notify the thread; notify those waiting for it.
  FrameBytesQueue waiting;
  bool closing = false;    // Write the queue, then end.
  bool abandoned = false;  // End immediately.
  bool is_busy = false;    // A piece is being written.
  bool has_ended = false;
  std::int64_t written = 0;
  std::int64_t bytes = 0;
  int error = 0;
};

void WriterThread::State::run() {
  std::string piece;
  std::unique_lock lock(mutex);
  while (!abandoned && error == 0) {
    work.wait(lock, [&] { return !waiting.empty() || closing || abandoned; });
    if (waiting.empty() || abandoned) break;
    waiting.take(piece);
    is_busy = true;
    lock.unlock();
    const bool done = write(piece);
    const int failed = errno;
    lock.lock();
    is_busy = false;
    if (done) ++written;
    if (!done && !abandoned) error = failed;
    change.notify_all();
  }
  has_ended = true;
  change.notify_all();
}

// @return false on failure (see errno) or if abandoned
bool WriterThread::State::write(std::string_view piece) {
  const std::size_t size = piece.size();
  while (!piece.empty()) {
    const ssize_t count = write_within(to, kind, piece, kLookAtEnd);
    if (count < 0) {
      const int failed = errno;
      if (kind == DescriptorKind::kFile) remove_cut_piece(size - piece.size());
      errno = failed;
      return false;
    }
    piece.remove_prefix(static_cast<std::size_t>(count));
    const std::lock_guard lock(mutex);
    bytes += count;
    if (abandoned && !piece.empty()) return false;
  }
  return true;
}

void WriterThread::State::remove_cut_piece(std::size_t written_bytes) const {
  if (written_bytes == 0) return;
  const off_t end = ::lseek(to.number(), 0, SEEK_CUR);
  if (end < static_cast<off_t>(written_bytes)) return;
  const off_t begin = end - static_cast<off_t>(written_bytes);
  if (::ftruncate(to.number(), begin) == 0) ::lseek(to.number(), begin, SEEK_SET);
}

WriterThread::WriterThread(Descriptor to, FrameBytesQueue::Bounds bounds)
    : state_(std::make_shared<State>(std::move(to), bounds)) {
  // Signals are left to the other threads. Blocking SIGPIPE turns a closed reader into an error
  // code.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    std::thread([state = state_] { state->run(); }).detach();
  } catch (const std::system_error& failed) {
    state_->error = failed.code().value();
    state_->has_ended = true;
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

WriterThread::~WriterThread() {
  std::unique_lock lock(state_->mutex);
  state_->abandoned = true;
  state_->work.notify_all();
  state_->change.wait_for(lock, kLeaveWithin, [&] { return state_->has_ended; });
}

bool WriterThread::put(std::string_view piece) {
  const std::lock_guard lock(state_->mutex);
  if (state_->error != 0 || !state_->waiting.has_room(piece.size())) return false;
  state_->waiting.push(piece);
  state_->work.notify_one();
  return true;
}

bool WriterThread::put_in_time(std::string_view piece, const std::function<bool()>& is_stopped) {
  while (!put(piece)) {
    std::unique_lock lock(state_->mutex);
    if (state_->error != 0 || (is_stopped && is_stopped())) return false;
    state_->change.wait_for(lock, kLookAtEnd, [&] {
      return state_->error != 0 || state_->waiting.has_room(piece.size());
    });
  }
  return true;
}

WriterThread::Progress WriterThread::progress() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->written, state_->error, state_->waiting.empty() && !state_->is_busy};
}

bool WriterThread::finish(bool is_patient, const std::function<bool()>& is_stopped) {
  std::unique_lock lock(state_->mutex);
  state_->closing = true;
  state_->work.notify_all();
  std::int64_t bytes = state_->bytes;
  auto latest = Clock::now(), begin = latest;
  while (!state_->change.wait_for(lock, kLookAtEnd, [&] { return state_->has_ended; })) {
    const auto now = Clock::now();
    const bool is_waiting = is_patient && !(is_stopped && is_stopped());
    if (is_waiting) begin = now;
    if (is_waiting || bytes != state_->bytes) latest = now;
    bytes = state_->bytes;
    const bool is_file = state_->kind == DescriptorKind::kFile;
    const bool is_slow = !is_file && now - begin > kSlowAfter;
    if (!is_slow && now - latest < (is_file ? kDiskWithoutProgress : kWithoutProgress)) continue;
    state_->abandoned = true;
    break;
  }
  return state_->error == 0 && state_->waiting.empty() && !state_->is_busy;
}

}  // namespace retarget
