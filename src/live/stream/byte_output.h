#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "live/stream/connection.h"
#include "live/stream/frame_output.h"
#include "live/stream/robot_frame_writer.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "live/stream/writer_thread.h"
#include "retarget/error.h"

namespace retarget {

/// Sends robot frames as JSON lines or CSV to datagrams, a connection, a file or standard output.
/// Errors: unavailable address; unwritable file.
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_byte_output(
    const StreamAddress& to, const FrameOutputContext& context);

/// Destination of a player's bytes: datagrams, a connection, standard output, or a file. Waits for
/// slow receivers.
class ByteSink {
 public:
  /// Errors: unavailable address; unwritable file.
  [[nodiscard]] static Result<ByteSink> open(const StreamAddress& address);

  /// Sends a datagram, or the next bytes; waits until they are written or it is stopped. Datagrams
  /// without a receiver are not an error.
  [[nodiscard]] Result<void> write(std::string_view bytes, const std::function<bool()>& is_stopped);
  [[nodiscard]] const StreamAddress& address() const { return address_; }

 private:
  StreamAddress address_;
  Descriptor to_;
  DescriptorKind kind_ = DescriptorKind::kOther;
};

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
