#include "batch/progress.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/text.h"

namespace retarget {
namespace {

// At most two units: 3 h 20 min, 45 s.
std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  if (whole >= 3600) {
    return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
  }
  if (whole >= 60) {
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  }
  return std::to_string(whole) + " s";
}

}  // namespace

BatchProgress::BatchProgress(Observer& observer, std::string folder, std::size_t clips,
                             std::uint64_t bytes)
    : observer_(observer), folder_(std::move(folder)), clips_(clips), bytes_(bytes) {}

double BatchProgress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void BatchProgress::finished(const ManifestEntry& entry) {
  const std::lock_guard lock(mutex_);
  bytes_done_ += entry.input.bytes;
  for (const MissingFile& missing : entry.not_written) {
    observer_.warn({{0, 0, "not written: " + missing.reason}}, folder_ + "/" + missing.file);
  }
  if (entry.done) {
    ++done_;
    frames_ += entry.frames;
    return;
  }
  ++failed_;
  if (!entry.error) return;
  observer_.fault(*entry.error);
}

void BatchProgress::skipped(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  ++unchanged_;
  bytes_unchanged_ += bytes;
}

void BatchProgress::show() {
  const std::lock_guard lock(mutex_);
  const double elapsed = seconds();
  std::string text =
      std::to_string(done_ + failed_ + unchanged_) + " / " + count_text(clips_, "clip");
  if (failed_ > 0) text += ", " + std::to_string(failed_) + " failed";
  if (frames_ > 0)
    text += ", " + number_text(static_cast<double>(frames_) / elapsed, 0) + " frames/s";
  if (bytes_done_ > 0) {
    const auto left =
        static_cast<double>(bytes_ - std::min(bytes_, bytes_done_ + bytes_unchanged_));
    text += ", " + duration_text(elapsed * left / static_cast<double>(bytes_done_)) + " left";
  }
  observer_.status(text);
}

std::string BatchProgress::work_text() const {
  const double elapsed = seconds();
  return count_text(frames_, "frame") + " in " + number_text(elapsed, 2) + " s, " +
         number_text(static_cast<double>(frames_) / std::max(elapsed, 1e-3), 0) + " frames/s";
}

}  // namespace retarget
