#include "live/stream/writer_thread.h"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "retarget/file.h"
#include "retarget/os.h"
#include "retarget/serve.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr auto kLookAtEnd = milliseconds(50);  // Interval at which waits check for the end.
constexpr auto kWithoutProgress = milliseconds(500), kDiskWithoutProgress = milliseconds(5000);
constexpr auto kSlowAfter = milliseconds(3000);   // For a slow reader.
constexpr auto kLeaveWithin = milliseconds(200);  // For a thread that was stopped.

// Readers fall behind by at most one second; a stalled disk may take longer.
FrameBytesQueue::Bounds bounds_of(bool is_file, const FrameOutputContext& context) {
  constexpr std::size_t kPipeBytes = std::size_t{1} << 20, kFileBytes = std::size_t{16} << 20;
  constexpr std::size_t kFileFrames = 16384;
  if (!context.waits && is_file) return {kFileFrames, kFileBytes};
  return {static_cast<std::size_t>(std::max(1.0, std::ceil(context.fps))), kPipeBytes};
}

}  // namespace

bool is_regular_file(const Descriptor& file) {
  return descriptor_kind(file) == DescriptorKind::kFile;
}

struct WriterThread::State {
  State(Descriptor file, FrameBytesQueue::Bounds bounds)
      : to(std::move(file)), kind(descriptor_kind(to)), waiting(bounds) {}

  void run();
  bool write(std::string_view piece);

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
      if (kind == DescriptorKind::kFile) remove_last_bytes(to, size - piece.size());
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

WriterThread::WriterThread(Descriptor to, FrameBytesQueue::Bounds bounds)
    : state_(std::make_shared<State>(std::move(to), bounds)) {
  // Leave signals to the other threads. Blocking SIGPIPE turns a closed reader into an error code.
  const WithoutSignals guard;
  try {
    std::thread([state = state_] { state->run(); }).detach();
  } catch (const std::system_error& failed) {
    state_->error = failed.code().value();
    state_->has_ended = true;
  }
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

Result<Descriptor> open_for_writing(const StreamAddress& to) {
  if (to.transport == Transport::kStdout) {
    Descriptor file = standard_stream(1);
    if (!file.is_open()) return run_failure(to.text(), "it is closed");
    return file;
  }
  RETARGET_TRY(check_output_folder(to.file));
  // Non-blocking, so that a pipe without a reader is an error at once.
  Descriptor file(os::open_file(to.file, os::OpenFor::kReplacing));
  if (file.is_open()) return file;
  if (errno == ENXIO) {
    return run_failure(to.file, "no process is reading this pipe", "start the receiver first");
  }
  return run_failure(to.file, std::string("cannot be written: ") + error_text(errno));
}

WriterOutput::WriterOutput(const StreamAddress& to, Descriptor file,
                           const FrameOutputContext& context,
                           std::unique_ptr<RobotFrameWriter> writer)
    : writer_(std::move(writer)),
      is_file_(is_regular_file(file)),
      thread_(std::move(file), bounds_of(is_file_, context)),
      account_(to.text(), context.tell),
      waits_(context.waits),
      is_stopped_(context.is_stopped) {
  const std::string header = writer_->header();
  if (!header.empty() && thread_.put(header)) headers_ = 1;
}

void WriterOutput::take(const RobotFrame& frame) {
  check_progress();
  if (account_.is_closed()) return account_.count_dropped();
  bytes_.clear();
  writer_->append(frame, bytes_);
  if (put(bytes_)) {
    ++queued_;
  } else {
    account_.count_dropped();
  }
  check_progress();
}

bool WriterOutput::put(std::string_view piece) {
  if (waits_) return thread_.put_in_time(piece, is_stopped_);
  if (thread_.put(piece)) return true;
  if (thread_.progress().error != 0) return false;
  account_.report_trouble("it is too slow");
  if (is_file_) account_.mark_incomplete();
  return false;
}

void WriterOutput::check_progress() {
  const WriterThread::Progress progress = thread_.progress();
  const std::int64_t sent = std::max<std::int64_t>(0, progress.written - headers_);
  account_.count_sent(sent - account_.statistics().sent);
  if (progress.error != 0) return end(progress.error);
  if (progress.is_idle) account_.report_recovery();
}

void WriterOutput::end(int error) {
  if (account_.is_closed()) return;
  account_.count_dropped(queued_ - account_.statistics().sent);
  if (error == EPIPE) return account_.close("its reader has closed it");
  account_.mark_incomplete();
  account_.close(error_text(error));
}

void WriterOutput::finish() {
  const bool is_whole = thread_.finish(waits_, is_stopped_);
  check_progress();
  if (account_.is_closed() || is_whole) return;
  account_.count_dropped(queued_ - account_.statistics().sent);
  if (is_file_) account_.mark_incomplete();
}

MessageWriter::MessageWriter(int descriptor) {
  constexpr FrameBytesQueue::Bounds kQueued = {256, std::size_t{64} << 10};
  thread_ = std::make_unique<WriterThread>(standard_stream(descriptor), kQueued);
}

MessageWriter::~MessageWriter() {
  if (thread_) thread_->finish(false, {});
}

MessageWriter::MessageWriter(MessageWriter&&) noexcept = default;
MessageWriter& MessageWriter::operator=(MessageWriter&&) noexcept = default;

void MessageWriter::write(std::string_view text) {
  static_cast<void>(thread_->put(text));
}

}  // namespace retarget
