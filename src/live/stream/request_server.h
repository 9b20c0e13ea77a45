#pragma once

#include <chrono>
#include <functional>
#include <string_view>
#include <vector>

#include "live/stream/decoder.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

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
