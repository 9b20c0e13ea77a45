#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "live/stream/frame_output.h"
#include "live/stream/writer_thread.h"
#include "retarget/error.h"

namespace retarget {

/// Events of a stream, recorded in their order.
enum class StreamEvent : char {
  kPacket = 'P',
  kNewSender = 'S',
  kRecalibrate = 'C',
  kEnd = 'E',
  kSkip = 'T',   ///< The run was interrupted until this time; robot frames were dropped.
  kBody = 'B',   ///< Switch to a body recognised in the background.
  kEarly = 'F',  ///< A packet that a new sender sent before it was accepted.
};

/// The file of the recorded input in the folder of a recording.
[[nodiscard]] std::string recorded_input_in(const std::string& folder);

/// Writes the file of a recorded input: for each event a line `LETTER MICROSECONDS BYTES`, then the
/// bytes and a line end. Times are arrival times since the start of the run. A thread writes the
/// file, so that a stalled disk does not delay the session. A recording that cannot continue ends
/// with the last complete event.
class StreamRecorder {
 public:
  /// Errors (kRun): the file is not writable.
  [[nodiscard]] static Result<StreamRecorder> create(const std::string& file,
                                                     const FrameOutputContext& context);
  void add(StreamEvent event, std::int64_t microseconds, std::string_view bytes = {});
  /// Errors (kRun): the file is incomplete.
  [[nodiscard]] Result<void> finish();

 private:
  StreamRecorder(std::string name, const FrameOutputContext& context, Descriptor file);
  void end();

  std::string name_;
  LiveTell tell_;
  std::function<bool()> is_stopped_;
  bool waits_;
  std::unique_ptr<WriterThread> thread_;
  std::string event_;
  bool has_ended_ = false;
};

/// Reads a recorded input.
class StreamReplay {
 public:
  [[nodiscard]] static Result<StreamReplay> open(const std::string& file);

  struct Entry {
    StreamEvent event = StreamEvent::kEnd;
    std::int64_t microseconds = 0;
    std::string bytes;
  };
  /// Reads the next event; false at the end. Errors (kInput): invalid event.
  [[nodiscard]] Result<bool> next(Entry& entry);

 private:
  std::string name_;
  std::ifstream file_;
  std::int64_t latest_ = 0;
};

}  // namespace retarget
