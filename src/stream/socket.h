#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/error.h"
#include "stream/stream_address.h"

namespace retarget {

/// A file descriptor that is closed with its owner.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  void close();

 private:
  int number_ = -1;
};

/// A socket that takes datagrams, or connections, at an address. Port 0: any that is free.
[[nodiscard]] Result<Descriptor> bind_socket(const StreamAddress& address);
/// A socket that takes the datagrams to a group of receivers (multicast), by the network that the
/// address' host is in, at its port. Errors: kUsage: no group; kRun: it cannot be joined.
[[nodiscard]] Result<Descriptor> join_group(const StreamAddress& address, const std::string& group);
/// The port that a bound socket has.
[[nodiscard]] int bound_port(const Descriptor& socket);
/// A socket that sends datagrams to an address, or is connected to it.
[[nodiscard]] Result<Descriptor> connect_socket(const StreamAddress& address);

/// Waits until one of two descriptors has something, or a connection; a closed one never has.
/// @return which: 0, 1; -1: neither within the time.
[[nodiscard]] int wait_for(const Descriptor& first, const Descriptor& second, double seconds);

/// A socket that begins to connect to an address and waits for nothing, now or later.
[[nodiscard]] Result<Descriptor> begin_connection(const StreamAddress& address);
/// What has come, as far as it fits; empty: nothing. Of a connection or a pipe that has ended: an
/// empty text, and `ended`.
[[nodiscard]] std::string_view receive(const Descriptor& from, std::span<char> room, bool& ended);
/// Sends a datagram from a socket that is bound; one that cannot be sent is lost.
void send_datagram(const Descriptor& from, const StreamAddress& to, std::string_view bytes);
/// The next datagram, and who sent it; empty: there is none.
[[nodiscard]] std::string_view receive_from(const Descriptor& from, std::span<char> room,
                                            StreamAddress& sender);
/// The next connection; not open: there is none.
[[nodiscard]] Descriptor accept_connection(const Descriptor& listener);

}  // namespace retarget
