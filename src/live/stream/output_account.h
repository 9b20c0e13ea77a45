#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "live/stream/frame_output.h"

namespace retarget {

/// Counts an output's frames and reports when it stops accepting them and when it recovers.
class OutputAccount {
 public:
  OutputAccount(std::string name, LiveTell tell) : tell_(std::move(tell)) {
    statistics_.name = std::move(name);
  }

  void count_sent(std::int64_t frames = 1) { statistics_.sent += frames; }
  void count_dropped(std::int64_t frames = 1) { statistics_.dropped += frames; }
  void count_reconnect() { ++statistics_.reconnects; }
  /// Reports that the output accepts no frames; once until report_recovery.
  void report_trouble(std::string_view reason);
  /// Reports, after a trouble, that the output accepts frames again.
  void report_recovery();
  /// The output accepts no more frames.
  void close(std::string_view reason);
  void mark_incomplete() { statistics_.is_incomplete = true; }

  [[nodiscard]] bool is_closed() const { return statistics_.is_closed; }
  [[nodiscard]] const OutputStatistics& statistics() const { return statistics_; }

 private:
  OutputStatistics statistics_;
  LiveTell tell_;
  std::int64_t dropped_before_ = 0;  // At the start of the trouble.
  int reports_ = 0;
  bool in_trouble_ = false;
};

}  // namespace retarget
