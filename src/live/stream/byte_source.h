#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/message_cutter.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "live/stream/stream_formats.h"
#include "retarget/error.h"

namespace retarget {

/// Permitted senders, from the parameter `from=`: `any`, an address, or an address with a port.
struct SenderFilter {
  bool any = false;                   ///< Accept all senders at the same time.
  std::optional<std::uint32_t> host;  ///< Empty: the first sender.
  std::optional<std::uint16_t> port;

  /// Errors (kUsage): not an address.
  [[nodiscard]] static Result<SenderFilter> parse(const std::string& text);
  [[nodiscard]] bool admits(const Endpoint& sender) const {
    return (!host || *host == sender.host) && (!port || *port == sender.port);
  }
};

/// Decides which datagrams to accept: those of the first sender, until it has been silent for a
/// second; then the next sender takes over. A program that opens a new port for each datagram is
/// a single sender.
class SenderLock {
 public:
  enum class Verdict : unsigned char {
    kSender,     ///< The packet is from the sender.
    kNewSender,  ///< It is from another machine or program, which becomes the sender.
    kStranger,   ///< It must be ignored.
  };

  /// @param any_port  treat all ports of a machine as one sender, for protocols that use several.
  explicit SenderLock(SenderFilter filter = {}, bool any_port = false)
      : filter_(filter), any_port_(any_port) {}

  /// @param now  seconds, any clock
  /// @param earliest  earliest possible arrival time, same clock. After a stall of this program, a
  ///     datagram of the sender may be next in the queue.
  [[nodiscard]] Verdict judge(const Endpoint& from, double now, double earliest);
  [[nodiscard]] Verdict judge(const Endpoint& from, double now) { return judge(from, now, now); }
  [[nodiscard]] const std::optional<Endpoint>& sender() const { return sender_; }

 private:
  // A port of the sender's machine that has sent recently.
  struct Port {
    std::uint16_t number = 0;
    double latest = 0.0;
    int datagrams = 0;  // Zero: the slot is free.
  };
  [[nodiscard]] bool has_sent_recently(std::uint16_t port, double now);

  SenderFilter filter_;
  bool any_port_;
  std::optional<Endpoint> sender_;
  double latest_ = 0.0;     // Time of the sender's last datagram.
  bool is_steady_ = false;  // It has sent more than one datagram from its port.
  std::array<Port, 8> ports_;
};

/// The first datagrams of senders that are not accepted. A program that restarts sends its skeleton
/// first, but is accepted only after its predecessor has been silent for a second.
class EarlyDatagrams {
 public:
  void keep(const Endpoint& from, std::string_view bytes, double now);
  /// Removes and returns the datagrams of a sender, in order.
  [[nodiscard]] std::vector<std::string> take(const Endpoint& from);

 private:
  struct Sender {
    Endpoint address;
    double latest = 0.0;  // Seconds.
    std::vector<std::string> datagrams;
  };
  std::vector<Sender> senders_;
};

/// The connections of a TCP input. One of them belongs to the sender. The others wait unread until
/// the sender has disconnected or been silent for a second and they have sent something.
class SenderConnections {
 public:
  SenderConnections() = default;
  SenderConnections(Descriptor listener, SenderFilter filter)
      : listener_(std::move(listener)), filter_(filter) {}

  enum class Event : unsigned char {
    kIdle,       ///< Nothing arrived.
    kNothing,    ///< Another connection began or ended.
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
  /// Number of connections that did not become the sender's, or only later.
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

/// Input that a source did not pass on.
struct SourceStatistics {
  std::int64_t strangers = 0;      ///< Datagrams or connections of other senders.
  std::int64_t dropped_lines = 0;  ///< Lines that are too long, or too many in a datagram.
};

/// Receives packets from a socket or standard input: datagrams, parts of a connection, or lines of
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
    kIdle,         ///< Nothing arrived.
    kNothing,      ///< A part of a packet, or the packet of another sender.
    kPacket,       ///< Available in packet().
    kNewSender,    ///< Another sender takes over.
    kEarlyPacket,  ///< One of its packets from before, in packet().
    kEnd,          ///< The input has ended.
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
  Event next_early();
  [[nodiscard]] double now() const;
  void report_stranger(const Endpoint& stranger);

  StreamAddress address_;
  bool is_text_;
  Tell tell_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();

  Descriptor socket_, group_;  // Unicast and multicast datagrams.
  Descriptor pipe_;
  SenderLock lock_;
  double emptied_ = 0.0;  // Last time at which no datagram was waiting, seconds.
  SenderConnections connections_;
  std::optional<Endpoint> server_;

  std::vector<char> room_;
  LineCutter lines_;
  std::string_view packet_;
  std::optional<std::string_view> held_back_;  // First datagram of a new sender.
  EarlyDatagrams strangers_;
  std::vector<std::string> early_;  // Of the new sender, in reverse order.
  std::string early_bytes_;
  bool is_early_ = false;  // The packet, or the lines, are of early_bytes_.
  bool ended_ = false;
  std::int64_t strange_datagrams_ = 0;
  bool is_stranger_reported_ = false;
};

}  // namespace retarget
