#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/frame_output.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"

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

/// Encodes robot frames as bytes.
class RobotFrameWriter {
 public:
  virtual ~RobotFrameWriter() = default;
  /// Bytes that receivers need first; empty: none.
  [[nodiscard]] virtual std::string header() const = 0;
  /// Appends a frame.
  virtual void append(const RobotFrame& frame, std::string& bytes) = 0;
};

/// Writes JSON lines: `{"frame", "time", "state", "root_position", "root_rotation" w x y z,
/// "joints"}`; the first line names robot, rate and joints.
/// @param held  joints that do not follow the human; if any, the first line names them and the
///     root.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_json_frame_writer(
    std::shared_ptr<const Robot> robot, double fps, std::vector<std::string> held = {});
/// Writes rows of Unitree's CSV, as offline runs do.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_csv_frame_writer(
    std::shared_ptr<const Robot> robot);

/// @param format  `jsonl` or `csv`; empty: `csv` for files with this extension, otherwise `jsonl`.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_frame_writer(
    const std::string& format, const std::string& file, std::shared_ptr<const Robot> robot,
    double fps, std::vector<std::string> held = {});

/// Name of a state: `following`, `holding`, ...
[[nodiscard]] std::string_view live_state_name(LiveState state);

}  // namespace retarget
