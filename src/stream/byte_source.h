#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "stream/socket.h"
#include "stream/stream_address.h"

namespace retarget {

/// Packets from a socket or standard input: datagrams, pieces of a connection, or lines of either.
class ByteSource {
 public:
  /// Of UDP, `multicast=GROUP` joins a group of receivers, and `server=HOST` names who may be asked, at
  /// `command=PORT`.
  /// @param lines         cut at line ends; a datagram's last line needs none.
  /// @param request_port  where senders are asked usually; 0: they are not.
  [[nodiscard]] static Result<ByteSource> open(const StreamAddress& address, bool lines,
                                               int request_port = 0);

  enum class Event : unsigned char {
    kNothing,
    kPacket,     ///< packet() has it.
    kNewSender,  ///< A connection begins.
    kEnd,        ///< Nothing more can come.
  };
  /// Waits so long at most.
  [[nodiscard]] Event wait(double seconds);
  /// Valid until the next wait.
  [[nodiscard]] std::string_view packet() const { return packet_; }
  /// The port that was had, of a socket.
  [[nodiscard]] int port() const { return bound_port(group_ ? connection_ : socket_); }
  /// Whether a server is known that may be asked; and sends it a datagram.
  [[nodiscard]] bool can_send() const { return server_.has_value(); }
  void send(std::string_view bytes);
  /// Lines that were too long to be any.
  [[nodiscard]] long overlong() const { return overlong_; }

 private:
  bool take_line(bool last);
  Event take_bytes(const Descriptor& from);

  StreamAddress address_;
  bool lines_ = true;
  Result<void> open_datagrams(int request_port);

  Descriptor socket_, connection_;
  bool group_ = false;  // the connection is that of a group's datagrams
  std::optional<StreamAddress> server_;
  std::vector<char> room_;
  std::string waiting_;  // bytes of lines that are not taken yet
  std::size_t taken_ = 0;
  bool datagram_ = false;  // what waits is whole
  bool ended_ = false;
  bool skips_ = false;  // until the next line end
  long overlong_ = 0;
  std::string_view packet_;
};

}  // namespace retarget
