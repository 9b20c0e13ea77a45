#pragma once

/// Addresses in the form of the system's sockets. Only for files that call socket functions.

#ifdef _WIN32
#include <winsock2.h>
// Must follow winsock2.h.
#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#endif

#include <cerrno>
#include <string>
#include <utility>

#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// The address 0.0.0.0 if the host is not a number.
inline sockaddr_in socket_address(const StreamAddress& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.host.c_str(), &result.sin_addr);
  return result;
}

inline sockaddr_in socket_address(const Endpoint& endpoint) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(endpoint.port);
  result.sin_addr.s_addr = htonl(endpoint.host);
  return result;
}

inline Endpoint endpoint(const sockaddr_in& place) {
  return {ntohl(place.sin_addr.s_addr), ntohs(place.sin_port)};
}

/// Whether an address is a multicast address, 224.0.0.0 to 239.255.255.255.
inline bool is_multicast(const sockaddr_in& place) {
  return endpoint(place).host >> 28U == 0xeU;
}

/// The failure of a socket call, with the message for errno.
inline Failure socket_failure(const StreamAddress& address, const char* what,
                              std::string hint = {}) {
  return run_failure(address.text(), std::string(what) + ": " + error_text(errno), std::move(hint));
}

}  // namespace retarget
