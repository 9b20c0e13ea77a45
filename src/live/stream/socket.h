#pragma once

#include <sys/types.h>
#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Owns a file descriptor, or a socket, and closes it. Windows numbers the two separately.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  [[nodiscard]] static Descriptor of_socket(int number) {
    Descriptor made(number);
    made.is_socket_ = true;
    return made;
  }
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept
      : number_(std::exchange(other.number_, -1)), is_socket_(other.is_socket_) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    std::swap(is_socket_, other.is_socket_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  [[nodiscard]] bool is_socket() const { return is_socket_; }
  void close();

 private:
  int number_ = -1;
  bool is_socket_ = false;
};

/// Duplicates the descriptor of standard input (0), output (1) or error (2).
[[nodiscard]] Descriptor standard_stream(int number);

/// Opens a socket that receives datagrams, or listens for connections, at an address. Port 0: any
/// free port.
[[nodiscard]] Result<Descriptor> bind_socket(const StreamAddress& address);
/// Opens a socket that receives the datagrams of a multicast group on the network interface that
/// has the address's host, at its port. Errors: kUsage: not a multicast group; kRun: the group
/// cannot be joined.
[[nodiscard]] Result<Descriptor> join_group(const StreamAddress& address, const std::string& group);
[[nodiscard]] int bound_port(const Descriptor& socket);
/// Opens a socket that sends datagrams to an address, or is connected to it.
[[nodiscard]] Result<Descriptor> connect_socket(const StreamAddress& address);

/// Waits until one of at most 16 descriptors has input or a connection. Closed descriptors are
/// ignored.
/// @return index of the first one; -1: none within the time.
[[nodiscard]] int wait_for(std::span<const Descriptor* const> sources, double seconds);

/// Opens a non-blocking socket and starts connecting it to an address.
[[nodiscard]] Result<Descriptor> begin_connection(const StreamAddress& address);
/// Waits for the end of begin_connection.
/// @return 0: connected; an error number; nothing: not yet.
[[nodiscard]] std::optional<int> finish_connection(const Descriptor& socket, double seconds);
/// Sends the first bytes of a text through a socket. A datagram is sent as a whole.
/// @param waits  whether to wait until a full socket accepts some bytes.
/// @return number of bytes; negative: see errno.
[[nodiscard]] ssize_t send_bytes(const Descriptor& to, std::string_view bytes, bool waits = false);
/// Receives from a connection without waiting.
/// @return number of bytes; 0: the peer has closed it; negative: see errno.
[[nodiscard]] ssize_t receive_bytes(const Descriptor& from, std::span<char> room);
/// Reads the available input, as much as fits; empty if there is none. At the end of a connection
/// or pipe, returns an empty text and sets `ended`.
[[nodiscard]] std::string_view receive(const Descriptor& from, std::span<char> room, bool& ended);
/// Sends a datagram from a bound socket; failures are ignored.
void send_datagram(const Descriptor& from, const Endpoint& to, std::string_view bytes);
/// Reads the next datagram and its sender; nothing if none is available.
[[nodiscard]] std::optional<std::string_view> receive_from(const Descriptor& from,
                                                           std::span<char> room, Endpoint& sender);
/// Accepts the next connection and its peer; not open if there is none.
[[nodiscard]] Descriptor accept_connection(const Descriptor& listener, Endpoint& peer);
/// Whether a connection has input or has ended; consumes nothing.
[[nodiscard]] bool has_input(const Descriptor& connection);
/// Whether a connection has ended and all its input was read.
[[nodiscard]] bool has_ended(const Descriptor& connection);

/// The type of a descriptor, as far as it matters for writing.
enum class DescriptorKind : unsigned char {
  kFile,    ///< A regular file, which is always ready.
  kSocket,  ///< A socket.
  kOther,   ///< A pipe, a terminal or a device.
};

[[nodiscard]] DescriptorKind descriptor_kind(const Descriptor& descriptor);

/// Writes the first bytes of a text, as many as the descriptor accepts; waits at most the given
/// time for it to become ready. Also works on blocking descriptors.
/// @return number of bytes written; 0: not ready; negative: error, see errno.
[[nodiscard]] ssize_t write_within(const Descriptor& to, DescriptorKind kind,
                                   std::string_view bytes, std::chrono::milliseconds wait);
/// Removes the last bytes of a file that was written up to here.
void remove_last_bytes(const Descriptor& file, std::size_t count);

/// The system's message for an errno of these functions.
[[nodiscard]] std::string error_text(int error_number);

/// While alive, threads that this thread starts receive no signals.
class WithoutSignals {
 public:
  WithoutSignals();
  ~WithoutSignals();
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;

 private:
  struct Before;
  std::unique_ptr<Before> before_;
};

/// While alive, sets the timer resolution to 1 ms on Windows; no effect elsewhere.
class ExactWaits {
 public:
  ExactWaits();
  ~ExactWaits();  // NOLINT(performance-trivially-destructible): not on Windows
  ExactWaits(const ExactWaits&) = delete;
  ExactWaits& operator=(const ExactWaits&) = delete;
};

}  // namespace retarget
