#pragma once

#include <memory>
#include <string>
#include <vector>

#include "live/stream/frame_bytes_queue.h"
#include "live/stream/frame_output.h"
#include "live/stream/output_account.h"
#include "live/stream/patient_connection.h"
#include "live/stream/robot_frame_writer.h"
#include "retarget/error.h"

namespace retarget {

/// Sends robot frames over a TCP connection without blocking. A receiver that falls behind by more
/// than a second loses the oldest frames, always complete ones. A lost connection is re-established
/// and starts with the header again.
class ConnectionOutput final : public FrameOutput {
 public:
  ConnectionOutput(const StreamAddress& to, const FrameOutputContext& context,
                   std::unique_ptr<RobotFrameWriter> writer);

  /// Errors: no listener.
  [[nodiscard]] Result<void> open();
  void take(const RobotFrame& frame) override;
  void finish() override;
  [[nodiscard]] const OutputStatistics& statistics() const override {
    return account_.statistics();
  }

 private:
  void begin();
  void lose();
  void drop_waiting();
  void queue(std::string_view frame);
  void send_waiting();
  [[nodiscard]] bool is_idle() const { return sent_of_current_ == current_.size(); }

  PatientConnection connection_;
  std::unique_ptr<RobotFrameWriter> writer_;
  OutputAccount account_;
  FrameBytesQueue waiting_;
  std::string bytes_;
  std::string current_;  // Frame being sent; first the header.
  std::size_t sent_of_current_ = 0;
  bool is_header_ = false;
  bool was_open_ = false;
};

}  // namespace retarget
