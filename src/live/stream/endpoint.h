#pragma once

#include <cstdint>
#include <string>

#include "live/stream/stream_address.h"

namespace retarget {

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
