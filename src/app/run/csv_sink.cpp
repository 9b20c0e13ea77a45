#include "app/run/csv_sink.h"
#include "base/try.h"

#include <new>
#include <system_error>
#include <utility>

namespace retarget {
namespace {

constexpr std::size_t kChunkFrames = 64;

}  // namespace

Result<std::unique_ptr<CsvSink>> CsvSink::open(const std::string& path,
                                               std::shared_ptr<const Robot> robot,
                                               const Options& options) {
  std::optional<OutputFile> file;
  if (!path.empty()) {
    TRY_ASSIGN(file, OutputFile::create(path));
  }
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  return std::unique_ptr<CsvSink>(
      new CsvSink(std::move(file), std::move(hasher), std::move(robot), options));
}

CsvSink::CsvSink(std::optional<OutputFile> file, ContentHasher hasher,
                 std::shared_ptr<const Robot> robot, const Options& options)
    : file_(std::move(file)),
      robot_(std::move(robot)),
      options_(options),
      formatter_(*robot_, options.csv),
      text_(formatter_.header()),
      hasher_(std::move(hasher)) {
  const std::size_t room = kChunkFrames * robot_->zero_configuration().size();
  filling_.reserve(room);
  waiting_.reserve(room);
  try {
    writer_ = std::thread([this] { write_chunks(); });
  } catch (const std::system_error&) {
    // Without a thread, write in the caller's thread.
  }
}

CsvSink::~CsvSink() {
  if (!writer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_all();
  writer_.join();
}

void CsvSink::add(std::span<const double> qpos) {
  filling_.insert(filling_.end(), qpos.begin(), qpos.end());
  if (filling_.size() == kChunkFrames * qpos.size()) hand_over();
}

void CsvSink::hand_over() {
  if (!writer_.joinable()) {
    write_frames(filling_);
    filling_.clear();
    return;
  }
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_.empty(); });
    std::swap(waiting_, filling_);
  }
  changed_.notify_all();
}

void CsvSink::write_chunks() {
  std::vector<double> frames;
  frames.reserve(waiting_.capacity());
  while (true) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return done_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      std::swap(frames, waiting_);
    }
    changed_.notify_all();
    write_frames(frames);
    frames.clear();
  }
}

void CsvSink::write_frames(std::vector<double>& frames) {
  if (!written_) return;
  const std::size_t width = robot_->zero_configuration().size();
  try {
    for (std::size_t begin = 0; begin < frames.size(); begin += width) {
      const auto qpos = std::span<double>(frames).subspan(begin, width);
      if (options_.normalize_start) {
        if (!normalizer_) normalizer_.emplace(qpos);
        normalizer_->apply(qpos);
      }
      formatter_.append_line(qpos, text_, frames_++);
    }
  } catch (const std::bad_alloc&) {
    written_ = run_failure("", "not enough memory for a line of the output");
    return;
  }
  if (!file_ || !file_->is_direct()) write_text();
}

void CsvSink::write_text() {
  hasher_.update(text_);
  if (file_) written_ = file_->write(text_);
  text_.clear();
}

Result<std::string> CsvSink::flush() {
  if (!filling_.empty()) hand_over();
  if (writer_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_all();
    writer_.join();
  }
  // Also writes the header of a clip without frames.
  if (written_) write_text();
  if (!written_) return failure(written_.error());
  return hasher_.finish();
}

Result<void> CsvSink::commit() {
  return file_ ? file_->commit() : Result<void>();
}

}  // namespace retarget
