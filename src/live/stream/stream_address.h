#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// Transport of bytes.
enum class Transport : unsigned char { kUdp, kTcp, kStdin, kStdout, kFile, kZmq, kRedis };

/// Source or destination of a stream: `udp:1118?format=bvh`, `tcp:0.0.0.0:9763`, `stdin`, `-`,
/// `motion.csv`, `zmq:5556`, `redis:6379`.
struct StreamAddress {
  Transport transport = Transport::kUdp;
  std::string host = "127.0.0.1";  ///< IPv4 address, for transports with a port.
  int port = 0;
  std::string file;                                         ///< File name, for kFile.
  std::string format;                                       ///< Empty: the default in the context.
  std::vector<std::pair<std::string, std::string>> extras;  ///< Other parameters after `?`.

  /// Value of a parameter; empty if absent.
  [[nodiscard]] std::string extra(const std::string& name) const;
  /// The address as a user writes it.
  [[nodiscard]] std::string text() const;
};

/// Whether a UDP or TCP address is a loopback address.
[[nodiscard]] bool is_this_machine(const StreamAddress& address);

/// Parses an address. Text of none of the forms above is a file name. Errors (kUsage) state the
/// expected form.
[[nodiscard]] Result<StreamAddress> parse_address(const std::string& text);

/// Returns a kUsage error if the address has parameters after `?` that are not known.
[[nodiscard]] Result<void> check_extras(const StreamAddress& address,
                                        std::span<const std::string> known);

/// A numeric IPv4 address with a port.
struct Endpoint {
  std::uint32_t host = 0;
  std::uint16_t port = 0;

  friend bool operator==(const Endpoint&, const Endpoint&) = default;
  /// Text such as `10.0.0.2:9763`.
  [[nodiscard]] std::string text() const;
};

/// The endpoint of a UDP or TCP address.
[[nodiscard]] Endpoint endpoint_of(const StreamAddress& address);

}  // namespace retarget
