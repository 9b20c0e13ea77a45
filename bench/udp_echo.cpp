// Echoes every datagram: bench/live_latency.py measures the cost of a round trip without work.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdio>

int main() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  if (socket < 0 || ::bind(socket, reinterpret_cast<const sockaddr*>(&own), size) != 0) return 1;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size);
  std::printf("%d\n", ntohs(own.sin_port));
  std::fflush(stdout);
  static std::array<char, 65536> bytes;
  for (;;) {
    sockaddr_in sender{};
    socklen_t length = sizeof sender;
    auto* const from = reinterpret_cast<sockaddr*>(&sender);
    const ssize_t count = ::recvfrom(socket, bytes.data(), bytes.size(), 0, from, &length);
    if (count >= 0) ::sendto(socket, bytes.data(), static_cast<size_t>(count), 0, from, length);
  }
}
