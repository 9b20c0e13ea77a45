#pragma once

#include <cstddef>
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
  /// @param lines  cut at line ends; a datagram's last line needs none.
  [[nodiscard]] static Result<ByteSource> open(const StreamAddress& address, bool lines);

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
  [[nodiscard]] int port() const { return bound_port(socket_); }
  /// Lines that were too long to be any.
  [[nodiscard]] long overlong() const { return overlong_; }

 private:
  bool take_line(bool last);
  Event take_bytes(const Descriptor& from);

  StreamAddress address_;
  bool lines_ = true;
  Descriptor socket_, connection_;
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
