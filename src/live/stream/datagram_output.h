#pragma once

#include <memory>
#include <string>

#include "live/stream/frame_output.h"
#include "live/stream/output_account.h"
#include "live/stream/robot_frame_writer.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Sends robot frames as datagrams, one each. Whether they are received is unknown, except on this
/// machine, where frames to a closed port count as dropped.
class DatagramOutput final : public FrameOutput {
 public:
  DatagramOutput(const StreamAddress& to, const FrameOutputContext& context,
                 std::unique_ptr<RobotFrameWriter> writer);

  /// Errors: no socket available.
  [[nodiscard]] Result<void> open();
  void take(const RobotFrame& frame) override;
  [[nodiscard]] const OutputStatistics& statistics() const override { return statistics_; }

 private:
  [[nodiscard]] bool send(std::string_view bytes);

  StreamAddress to_;
  std::unique_ptr<RobotFrameWriter> writer_;
  std::string header_, bytes_;
  Descriptor socket_;
  OutputStatistics statistics_;
};

}  // namespace retarget
