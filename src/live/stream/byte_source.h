#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "live/stream/decoder.h"
#include "live/stream/line_cutter.h"
#include "live/stream/senders.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Input that a source did not pass on.
struct SourceStatistics {
  std::int64_t strangers = 0;      ///< Datagrams or connections from others than the sender.
  std::int64_t dropped_lines = 0;  ///< Lines that are too long, or too many in a datagram.
};

/// Receives packets from a socket or standard input: datagrams, pieces of a connection, or lines of
/// either. Accepts only one sender at a time (SenderLock, SenderConnections).
class ByteSource {
 public:
  /// Receives a human-readable message: a label and a text.
  using Tell = std::function<void(std::string_view label, std::string_view text)>;

  /// Opens a source. `from=ADDRESS` restricts the sender. For UDP, `multicast=GROUP` joins a
  /// multicast group, and `server=HOST` names the server for requests, at `command=PORT`.
  [[nodiscard]] static Result<ByteSource> open(const StreamAddress& address,
                                               const StreamFormat& format, Tell tell);

  enum class Event : unsigned char {
    kNothing,
    kPacket,     ///< Available in packet().
    kNewSender,  ///< Another sender takes over.
    kEnd,        ///< The input has ended.
  };
  /// Waits at most the given time.
  [[nodiscard]] Event wait(double seconds);
  /// Valid until the next wait.
  [[nodiscard]] std::string_view packet() const { return packet_; }
  /// The bound port of a socket.
  [[nodiscard]] int port() const;
  /// Whether a server for requests is known; send() sends it a datagram.
  [[nodiscard]] bool can_send() const { return server_.has_value(); }
  void send(std::string_view bytes);
  [[nodiscard]] SourceStatistics statistics() const;

 private:
  ByteSource(const StreamAddress& address, const StreamFormat& format, Tell tell);
  Result<void> open_datagrams(int request_port);
  Event wait_for_datagram(double seconds);
  Event wait_for_connection(double seconds);
  Event wait_for_pipe(double seconds);
  Event take_datagram(const Descriptor& from);
  Event take_piece(const Descriptor& from, bool& ended);
  Event give(std::string_view bytes);
  Event next_line();
  [[nodiscard]] double now() const;
  void report_stranger(const Endpoint& stranger);

  StreamAddress address_;
  bool is_text_;
  Tell tell_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();

  Descriptor socket_, group_;  // Unicast and multicast datagrams.
  Descriptor pipe_;
  SenderLock lock_;
  SenderConnections connections_;
  std::optional<Endpoint> server_;

  std::vector<char> room_;
  LineCutter lines_;
  std::string_view packet_;
  std::optional<std::string_view> held_back_;  // First datagram of a new sender.
  bool ended_ = false;
  std::int64_t strange_datagrams_ = 0;
  bool is_stranger_reported_ = false;
};

}  // namespace retarget
