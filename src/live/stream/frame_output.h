#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/stream_address.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"
#include "retarget/serve.h"

namespace retarget {

/// A destination of robot frames. No receiver delays the others: frames that a receiver does not
/// accept in time are dropped for it and counted.
class FrameOutput {
 public:
  virtual ~FrameOutput() = default;
  /// Sends a frame or drops it.
  virtual void take(const RobotFrame& frame) = 0;
  /// Sends buffered frames, either for a short time or until the receiver has accepted them.
  virtual void finish() {}
  [[nodiscard]] virtual const OutputStatistics& statistics() const = 0;
};

/// Parameters for opening an output.
struct FrameOutputContext {
  std::shared_ptr<const Robot> robot;
  double fps = 50.0;
  LiveTell tell = {};
  /// Files and standard output never drop frames but may block the run: for inputs that can wait,
  /// such as pipes.
  bool waits = false;
  std::function<bool()> is_stopped = {};  ///< Ends all waiting; may be empty.
  /// Joints held in the standing pose, for robots of which only the arms follow.
  std::vector<std::string> held = {};
};

/// Opens `zmq:PORT` and `redis:PORT`. Only builds with the library define them. Errors: those of
/// open_frame_output.
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_zmq_output(
    const StreamAddress& to, const FrameOutputContext& context);
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_redis_output(
    const StreamAddress& to, const FrameOutputContext& context);

/// Checks the address of an output before anything is opened. Errors (kUsage): unknown format, or
/// one that does not support the address; parameters after `?` that it does not support; a missing
/// folder.
[[nodiscard]] Result<void> check_frame_output(const StreamAddress& to);

/// Opens an output. Errors: those of check_frame_output; unavailable address; a format that does
/// not support this robot, or whose library the build lacks (kUsage).
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_frame_output(
    const StreamAddress& to, const FrameOutputContext& context);

/// All outputs of a live run. No output delays the others. Used by one thread.
class Outputs {
 public:
  /// Opens outputs: files last, because opening a file discards its content. Errors: those of
  /// open_frame_output.
  [[nodiscard]] Result<void> open(std::span<const StreamAddress> places,
                                  const FrameOutputContext& context);
  void take(const RobotFrame& frame);
  /// Whether no output accepts frames any more: readers have disconnected, disks are full.
  [[nodiscard]] bool are_closed() const;
  /// Sends buffered frames. Errors (kRun): a file lacks frames.
  [[nodiscard]] Result<void> finish();
  [[nodiscard]] std::vector<OutputStatistics> statistics() const;

 private:
  std::vector<std::unique_ptr<FrameOutput>> all_;
};

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
  virtual void append(const RobotFrame& frame, std::string& bytes) = 0;
};

/// Writes rows of Unitree's CSV, as offline runs do, or JSON lines: `{"frame", "time", "state",
/// "root_position", "root_rotation" w x y z, "joints"}`; the first line names robot, rate and
/// joints.
/// @param format  `jsonl` or `csv`; empty: `csv` for files with this extension, otherwise `jsonl`.
/// @param held    joints that do not follow the human; if any, the first line of JSON names them
///     and the root.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_frame_writer(
    const std::string& format, const std::string& file, std::shared_ptr<const Robot> robot,
    double fps, std::vector<std::string> held = {});

/// Name of a state: `following`, `holding`, ...
[[nodiscard]] std::string_view live_state_name(LiveState state);

}  // namespace retarget
