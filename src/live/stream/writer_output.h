#pragma once

#include <functional>
#include <memory>
#include <string>

#include "live/stream/frame_output.h"
#include "live/stream/output_account.h"
#include "live/stream/robot_frame_writer.h"
#include "live/stream/stream_address.h"
#include "live/stream/writer_thread.h"
#include "retarget/error.h"

namespace retarget {

/// Opens a file, a pipe or standard output for writing. Errors: not writable; the pipe has no
/// reader.
[[nodiscard]] Result<Descriptor> open_for_writing(const StreamAddress& to);

/// Writes robot frames to a file or standard output on its own thread.
class WriterOutput final : public FrameOutput {
 public:
  WriterOutput(const StreamAddress& to, Descriptor file, const FrameOutputContext& context,
               std::unique_ptr<RobotFrameWriter> writer);

  void take(const RobotFrame& frame) override;
  void finish() override;
  [[nodiscard]] const OutputStatistics& statistics() const override {
    return account_.statistics();
  }

 private:
  [[nodiscard]] bool put(std::string_view piece);
  void look_at_progress();
  void end(int error);

  std::unique_ptr<RobotFrameWriter> writer_;
  bool is_file_;  // A regular file.
  WriterThread thread_;
  OutputAccount account_;
  bool waits_;
  std::function<bool()> is_stopped_;
  std::string bytes_;
  std::int64_t queued_ = 0;   // Frames queued so far, written ones included.
  std::int64_t headers_ = 0;  // Pieces before the frames.
};

}  // namespace retarget
