#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "live/stream/byte_source.h"
#include "live/stream/frame_output.h"
#include "live/stream/live_pipeline.h"
#include "live/stream/socket.h"
#include "live/stream/writer_thread.h"
#include "retarget/error.h"

namespace retarget {

/// Histogram of the times from a packet to the robot frame that it made possible. Its memory does
/// not grow with the duration.
class Latency {
 public:
  void add(double seconds);
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] double max() const { return max_; }
  /// Percentile in seconds, accurate to 5 %; 0 without samples.
  [[nodiscard]] double percentile(double percent) const;

 private:
  std::array<std::int64_t, 400> counts_{};  // Bins; each bound is 5 % larger than the previous one.
  std::int64_t count_ = 0;
  double max_ = 0.0;
};

/// Writes statistics of a live run: one JSON line per second.
class StatsWriter {
 public:
  /// @param to  a file, which is overwritten; - for standard output.
  /// Errors (kRun): the file is not writable.
  [[nodiscard]] static Result<StatsWriter> open(const std::string& to);

  /// Adds a latency from a packet to its robot frame, seconds.
  void add(double latency_s) { latency_.add(latency_s); }
  /// Writes a line if a second has passed. Never blocks: a slow reader or disk misses lines.
  void write_if_due(double now, const LivePipeline& pipeline, const SourceStatistics& source,
                    std::span<const OutputStatistics> outputs);
  /// Writes the queued lines, within a bounded time.
  void finish();

 private:
  explicit StatsWriter(Descriptor to);

  std::unique_ptr<WriterThread> thread_;
  Latency latency_;  // In the current second.
  double due_ = 1.0;
  double before_ = 0.0;
  std::int64_t frames_before_ = 0;
};

}  // namespace retarget
