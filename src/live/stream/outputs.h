#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "live/stream/frame_output.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"
#include "retarget/live.h"

namespace retarget {

/// All outputs of a live run. No output delays the others. Used by one thread.
class Outputs {
 public:
  /// Errors: those of open_frame_output.
  [[nodiscard]] Result<void> add(const StreamAddress& to, const FrameOutputContext& context);
  void take(const RobotFrame& frame);
  /// Number of frames taken.
  [[nodiscard]] std::int64_t frames() const { return frames_; }
  /// Whether no output accepts frames any more: readers have disconnected, disks are full.
  [[nodiscard]] bool are_closed() const;
  /// Sends buffered frames. Errors (kRun): a file lacks frames.
  [[nodiscard]] Result<void> finish();
  [[nodiscard]] std::vector<OutputStatistics> statistics() const;

 private:
  std::vector<std::unique_ptr<FrameOutput>> all_;
  std::int64_t frames_ = 0;
};

}  // namespace retarget
