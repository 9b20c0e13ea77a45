#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "live/stream/endpoint.h"
#include "live/stream/sender_lock.h"
#include "live/stream/socket.h"

namespace retarget {

/// The connections of a TCP input. One of them belongs to the sender. The others wait unread until
/// the sender has disconnected or been silent for a second and they have sent something.
class SenderConnections {
 public:
  SenderConnections() = default;
  SenderConnections(Descriptor listener, SenderFilter filter)
      : listener_(std::move(listener)), filter_(filter) {}

  enum class Event : unsigned char {
    kNothing,
    kInput,      ///< The sender has sent bytes or disconnected.
    kNewSender,  ///< Another connection has become the sender's.
  };
  /// Waits at most the given time. @param now  seconds, same clock as in the other calls
  [[nodiscard]] Event wait(double seconds, double now);
  [[nodiscard]] const Descriptor& sender() const { return sender_.connection; }
  /// Notes that the sender's bytes were read.
  void note_input(double now) { latest_ = now; }
  void close_sender() { sender_ = {}; }
  /// Address of the sender; nothing if there is no sender.
  [[nodiscard]] std::optional<Endpoint> sender_peer() const {
    return sender_.connection.is_open() ? std::optional(sender_.peer) : std::nullopt;
  }

  [[nodiscard]] const Descriptor& listener() const { return listener_; }
  /// Number of connections that did not become the sender's, or not at once.
  [[nodiscard]] std::int64_t strangers() const { return strangers_; }
  /// The latest of these connections.
  [[nodiscard]] const Endpoint& latest_stranger() const { return latest_stranger_; }

 private:
  struct Connection {
    Descriptor connection;
    Endpoint peer;
  };
  [[nodiscard]] bool is_alive(double now) const;
  void accept();
  void drop_ended();
  [[nodiscard]] bool promote();

  Descriptor listener_;
  SenderFilter filter_;
  Connection sender_;
  double latest_ = 0.0;
  std::vector<Connection> waiting_;
  std::int64_t strangers_ = 0;
  Endpoint latest_stranger_;
};

}  // namespace retarget
