#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "batch/manifest.h"
#include "retarget/run.h"

namespace retarget {

/// Counts and reports the progress of a batch. Thread-safe.
class BatchProgress {
 public:
  /// @param folder  output folder, for messages.
  /// @param clips   number of tasks; each pair of clip and robot is one.
  /// @param bytes   total size of their inputs.
  BatchProgress(Observer& observer, std::string folder, std::size_t clips, std::uint64_t bytes);

  /// Counts a clip. Reports why it failed or why files of it were not written.
  void finished(const ManifestEntry& entry);
  /// Counts a clip that was already done.
  void skipped(std::uint64_t bytes);
  /// Reports clips done, frames per second and the remaining time.
  void show();

  [[nodiscard]] std::size_t done() const { return done_; }
  [[nodiscard]] std::size_t failed() const { return failed_; }
  [[nodiscard]] std::size_t unchanged() const { return unchanged_; }
  /// Example: `1234 frames in 5.67 s, 218 frames/s`
  [[nodiscard]] std::string work_text() const;

 private:
  [[nodiscard]] double seconds() const;

  Observer& observer_;
  const std::string folder_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const std::size_t clips_;
  const std::uint64_t bytes_;
  std::mutex mutex_;
  std::size_t done_ = 0, failed_ = 0, unchanged_ = 0;
  std::uint64_t bytes_done_ = 0, bytes_unchanged_ = 0;
  long frames_ = 0;
};

}  // namespace retarget
