#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "batch/manifest.h"
#include "run/observer.h"

namespace retarget {

/// What a batch has done so far, told as it goes. Thread-safe.
class BatchProgress {
 public:
  /// @param clips  to be done, a clip and robot being one,
  /// @param bytes  of their inputs together.
  BatchProgress(Observer& observer, std::size_t clips, std::uint64_t bytes);

  /// Counts a clip; the error of a failed one is printed.
  void finished(const ManifestEntry& entry);
  /// A clip that turned out to be done already.
  void skipped(std::uint64_t bytes);
  /// Clips done, frames per second, time left.
  void show();

  [[nodiscard]] std::size_t done() const { return done_; }
  [[nodiscard]] std::size_t failed() const { return failed_; }
  [[nodiscard]] std::size_t unchanged() const { return unchanged_; }
  /// `1234 frames in 5.67 s, 218 frames/s`
  [[nodiscard]] std::string work_text() const;

 private:
  [[nodiscard]] double seconds() const;

  Observer& observer_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const std::size_t clips_;
  const std::uint64_t bytes_;
  std::mutex mutex_;
  std::size_t done_ = 0, failed_ = 0, unchanged_ = 0;
  std::uint64_t bytes_done_ = 0, bytes_unchanged_ = 0;
  long frames_ = 0;
};

}  // namespace retarget
