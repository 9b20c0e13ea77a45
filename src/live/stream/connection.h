#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "live/stream/stream_formats.h"
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
  [[nodiscard]] const StreamAddress& address() const { return address_; }

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

}  // namespace retarget
