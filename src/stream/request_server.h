#pragma once

#include <chrono>
#include <functional>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "stream/decoder.h"
#include "stream/socket.h"
#include "stream/stream_address.h"

namespace retarget {

/// The part of a player that answers its receivers, for protocols whose senders are asked. Who asked
/// gets frames for a while: protocols keep asking.
class RequestServer {
 public:
  /// @param to            where frames go anyway; with `command=PORT` requests come to another port.
  /// @param request_port  where they come usually.
  [[nodiscard]] static Result<RequestServer> open(const StreamAddress& to, int request_port);

  /// Answers what is asked until then, or until it is stopped.
  void serve(Encoder& encoder, std::chrono::steady_clock::time_point then,
             const std::function<bool()>& is_stopped);
  /// Sends a datagram to all who asked.
  void send(std::string_view bytes);

 private:
  void take_request(Encoder& encoder);

  struct Receiver {
    StreamAddress address;
    std::chrono::steady_clock::time_point latest;
  };
  StreamAddress to_;
  Descriptor socket_;
  std::vector<Receiver> receivers_;
  std::vector<char> room_;
};

}  // namespace retarget
