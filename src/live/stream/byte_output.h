#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/frame_output.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "live/stream/stream_formats.h"
#include "live/stream/writer_thread.h"
#include "retarget/error.h"

namespace retarget {

/// A TCP connection for a loop that must not block: connects, transfers and reconnects as far as
/// possible without waiting.
class PatientConnection {
 public:
  using Clock = std::chrono::steady_clock;

  explicit PatientConnection(StreamAddress address) : address_(std::move(address)) {}

  /// Connects, waiting at most the given time. Errors: no answer.
  [[nodiscard]] Result<void> open(double seconds);

  /// Retries at intervals while not connected.
  void retry(Clock::time_point now);
  [[nodiscard]] bool is_open() const { return connected_; }
  /// Sends without blocking.
  /// @return number of bytes sent.
  [[nodiscard]] std::size_t send(std::string_view bytes);
  /// Received bytes, as many as fit; empty: none.
  [[nodiscard]] std::string_view receive(std::span<char> room);
  /// Closes the connection until the next retry.
  void close(std::string reason);
  /// Why the connection is not open, human-readable.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  void begin(Clock::time_point now);
  // Waits at most the given time for a pending connection.
  void finish(double seconds);

  StreamAddress address_;
  Descriptor socket_;
  bool connected_ = false;
  Clock::time_point next_try_;
  std::string reason_;
};

/// Answers the receivers of a player, for protocols with requests. A receiver gets frames for some
/// time after each request, because receivers repeat their requests.
class RequestServer {
 public:
  /// @param to            default destination of the frames; `command=PORT` sets another request
  ///   port.
  /// @param request_port  default port for requests.
  [[nodiscard]] static Result<RequestServer> open(const StreamAddress& to, int request_port);

  /// Answers requests until the given time or until stopped.
  void serve(Encoder& encoder, std::chrono::steady_clock::time_point then,
             const std::function<bool()>& is_stopped);
  /// Sends a datagram to all active receivers.
  void send(std::string_view bytes);

 private:
  void take_request(Encoder& encoder);

  struct Receiver {
    Endpoint address;
    std::chrono::steady_clock::time_point latest;
  };
  StreamAddress to_;
  Descriptor socket_;
  std::vector<Receiver> receivers_;
  std::vector<char> room_;
};

/// Sends robot frames as JSON lines or CSV to datagrams, a connection, a file or standard output.
/// Errors: unavailable address; unwritable file.
/// @pre check_frame_output() accepts the address.
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
