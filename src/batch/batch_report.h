#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/report.h"
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

/// The part of a report that a manifest keeps.
[[nodiscard]] ClipQuality clip_quality(const QualityReport& report);

/// Sorts entries: failed clips first, then by number of missed gates, by distance beyond a gate,
/// and by name.
[[nodiscard]] std::vector<const ManifestEntry*> worst_first(std::span<const ManifestEntry> entries);

/// A CSV table with a header and a row per clip and robot, the worst first. The columns are status,
/// clip, robot, frames, fps, duration_s, gates_missed, worst, worst_ratio, every metric by its key,
/// message and hint. The result does not depend on the order of the entries.
[[nodiscard]] std::string summary_csv(std::span<const ManifestEntry> entries);

/// Checks that at least one format can be listed for training frameworks. Errors: kUsage.
[[nodiscard]] Result<void> check_motion_list(const SaveOptions& options);

/// Writes `motions.yaml` for the finished clips of the manifest in a folder. This is the list
/// format of TWIST2, GMT, MimicKit and ProtoMotions: `root_path`, and `motions` with `file`,
/// `weight` 1 and `description` each. With several robots, each folder of a robot gets its own
/// list.
[[nodiscard]] Result<void> write_motion_lists(const std::string& folder, Observer& observer);

}  // namespace retarget
