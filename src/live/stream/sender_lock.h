#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "live/stream/endpoint.h"
#include "retarget/error.h"

namespace retarget {

/// Permitted senders, from the parameter `from=`: `any`, an address, or an address with a port.
struct SenderFilter {
  bool any = false;                   ///< Accept all senders at the same time.
  std::optional<std::uint32_t> host;  ///< Nothing: the first sender.
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
    kSender,     ///< From the sender.
    kNewSender,  ///< From another machine, which becomes the sender.
    kStranger,   ///< To be ignored.
  };

  /// @param any_port  treat all ports of a machine as one sender, for protocols that use several.
  explicit SenderLock(SenderFilter filter = {}, bool any_port = false)
      : filter_(filter), any_port_(any_port) {}

  /// @param now  seconds, any clock
  [[nodiscard]] Verdict judge(const Endpoint& from, double now);
  [[nodiscard]] const std::optional<Endpoint>& sender() const { return sender_; }

 private:
  // A port of the sender's machine that has sent recently.
  struct Port {
    std::uint16_t number = 0;
    double latest = 0.0;
    bool is_used = false;
  };
  [[nodiscard]] bool has_sent_lately(std::uint16_t port, double now);

  SenderFilter filter_;
  bool any_port_;
  std::optional<Endpoint> sender_;
  double latest_ = 0.0;     // Time of the sender's last datagram.
  bool is_steady_ = false;  // It has sent more than one datagram from its port.
  std::array<Port, 8> ports_;
};

}  // namespace retarget
