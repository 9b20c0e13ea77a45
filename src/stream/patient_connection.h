#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/error.h"
#include "stream/socket.h"
#include "stream/stream_address.h"

namespace retarget {

/// A connection by TCP for a loop that waits for nobody: it is made, used and made again as far as
/// goes at once.
class PatientConnection {
 public:
  using Clock = std::chrono::steady_clock;

  explicit PatientConnection(StreamAddress address) : address_(std::move(address)) {}

  /// Connects, and waits so long at most. Errors: nobody answers.
  [[nodiscard]] Result<void> open(double seconds);

  /// Tries again, now and then, where it is not connected.
  void retry(Clock::time_point now);
  [[nodiscard]] bool is_open() const { return connected_; }
  /// Sends what goes at once.
  /// @return bytes that went.
  [[nodiscard]] std::size_t send(std::string_view bytes);
  /// What has come, as far as it fits; empty: nothing.
  [[nodiscard]] std::string_view receive(std::span<char> room);
  /// Until it is tried again.
  void close(std::string reason);
  /// Why it is not open, for people.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] const StreamAddress& address() const { return address_; }

 private:
  void begin(Clock::time_point now);
  // waits so long for a connection that has begun
  void finish(double seconds);

  StreamAddress address_;
  Descriptor socket_;
  bool connected_ = false;
  Clock::time_point next_try_;
  std::string reason_;
};

}  // namespace retarget
