#include "live/stream/endpoint.h"

#include <fmt/format.h>

#include <utility>

namespace retarget {

std::string Endpoint::text() const {
  return fmt::format("{}.{}.{}.{}:{}", host >> 24, host >> 16 & 255, host >> 8 & 255, host & 255,
                     port);
}

Endpoint endpoint_of(const StreamAddress& address) {
  std::uint32_t host = 0, part = 0;
  for (const char c : address.host) {
    if (c == '.') {
      host = host << 8 | std::exchange(part, 0);
    } else {
      part = 10 * part + static_cast<std::uint32_t>(c - '0');
    }
  }
  return {host << 8 | part, static_cast<std::uint16_t>(address.port)};
}

}  // namespace retarget
