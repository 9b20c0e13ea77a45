#include "live/stream/writer_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "retarget/file.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Readers fall behind by at most one second; a stalled disk may take longer.
FrameBytesQueue::Bounds bounds_of(bool is_file, const FrameOutputContext& context) {
  constexpr std::size_t kPipeBytes = std::size_t{1} << 20, kFileBytes = std::size_t{16} << 20;
  constexpr std::size_t kFileFrames = 16384;
  if (!context.waits && is_file) return {kFileFrames, kFileBytes};
  return {static_cast<std::size_t>(std::max(1.0, std::ceil(context.fps))), kPipeBytes};
}

}  // namespace

Result<Descriptor> open_for_writing(const StreamAddress& to) {
  if (to.transport == Transport::kStdout) {
    Descriptor file(::dup(STDOUT_FILENO));
    if (!file.is_open()) return run_failure(to.text(), "it is closed");
    return file;
  }
  RETARGET_TRY(check_output_folder(to.file));
  constexpr int kMode = 0644;
  // Non-blocking, so that a pipe without a reader is an error at once.
  Descriptor file(
      ::open(to.file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, kMode));
  if (file.is_open()) return file;
  if (errno == ENXIO) {
    return run_failure(to.file, "no process is reading this pipe", "start the receiver first");
  }
  return run_failure(to.file, std::string("cannot be written: ") + std::strerror(errno));
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
  look_at_progress();
  if (account_.is_closed()) return account_.count_dropped();
  bytes_.clear();
  writer_->append(frame, bytes_);
  if (put(bytes_)) {
    ++queued_;
  } else {
    account_.count_dropped();
  }
  look_at_progress();
}

bool WriterOutput::put(std::string_view piece) {
  if (waits_) return thread_.put_in_time(piece, is_stopped_);
  if (thread_.put(piece)) return true;
  if (thread_.progress().error != 0) return false;
  account_.report_trouble("it does not keep up");
  if (is_file_) account_.mark_incomplete();
  return false;
}

void WriterOutput::look_at_progress() {
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
  account_.close(std::strerror(error));
}

void WriterOutput::finish() {
  const bool is_whole = thread_.finish(waits_, is_stopped_);
  look_at_progress();
  if (account_.is_closed() || is_whole) return;
  account_.count_dropped(queued_ - account_.statistics().sent);
  if (is_file_) account_.mark_incomplete();
}

}  // namespace retarget
