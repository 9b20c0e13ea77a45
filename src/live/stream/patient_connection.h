#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
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

}  // namespace retarget
