#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// What happens to a stream, in the order in which it does.
enum class StreamEvent : char {
  kPacket = 'P',
  kNewSender = 'S',
  kRecalibrate = 'C',
  kEnd = 'E',
};

/// The file of a recorded input: for each event a line `LETTER MICROSECONDS BYTES`, then the bytes and
/// a line end. Times are those of arrival, from the beginning of the run.
class StreamRecorder {
 public:
  /// Errors (kRun): it cannot be written.
  [[nodiscard]] static Result<StreamRecorder> create(const std::string& file);
  void add(StreamEvent event, std::int64_t microseconds, std::string_view bytes = {});
  [[nodiscard]] Result<void> finish();

 private:
  std::string name_;
  std::ofstream file_;
};

/// Reads such a file.
class StreamReplay {
 public:
  [[nodiscard]] static Result<StreamReplay> open(const std::string& file);

  struct Entry {
    StreamEvent event = StreamEvent::kEnd;
    std::int64_t microseconds = 0;
    std::string bytes;
  };
  /// The next event; false at the end. Errors (kInput): what is none.
  [[nodiscard]] Result<bool> next(Entry& entry);

 private:
  std::string name_;
  std::ifstream file_;
  std::int64_t latest_ = 0;
};

}  // namespace retarget
