#include "live/stream/socket.h"

#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

#include "live/stream/socket_address.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Child processes do not inherit it, and a closed connection sends no signal.
Descriptor own_socket(int number, bool blocks) {
  Descriptor made = Descriptor::of_socket(number);
  if (!made.is_open()) return made;
#ifndef SOCK_CLOEXEC
  ::fcntl(number, F_SETFD, FD_CLOEXEC);
  if (!blocks) ::fcntl(number, F_SETFL, ::fcntl(number, F_GETFL) | O_NONBLOCK);
  const int yes = 1;
  ::setsockopt(number, SOL_SOCKET, SO_NOSIGPIPE, &yes, sizeof yes);
#else
  static_cast<void>(blocks);
#endif
  return made;
}

#ifdef SOCK_CLOEXEC
constexpr int kOwn = SOCK_CLOEXEC, kNonBlocking = SOCK_NONBLOCK, kNoSignal = MSG_NOSIGNAL;
#else
constexpr int kOwn = 0, kNonBlocking = 0, kNoSignal = 0;
#endif

Result<Descriptor> open_socket(const StreamAddress& address, bool blocks = true) {
  const bool udp = address.transport == Transport::kUdp;
  const int type = (udp ? SOCK_DGRAM : SOCK_STREAM) | kOwn | (blocks ? 0 : kNonBlocking);
  Descriptor made = own_socket(::socket(AF_INET, type, 0), blocks);
  if (!made.is_open()) return socket_failure(address, "cannot create a socket");
  const int yes = 1;
  if (!udp) {
    // Send each frame at once.
    ::setsockopt(made.number(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  }
  return made;
}

}  // namespace

void Descriptor::close() {
  if (is_open()) ::close(number_);
  number_ = -1;
}

Descriptor standard_stream(int number) {
  return Descriptor(::dup(number));
}

Result<Descriptor> bind_socket(const StreamAddress& address) {
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  const bool tcp = address.transport == Transport::kTcp;
  const int yes = 1;
  if (tcp) ::setsockopt(made.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const sockaddr_in place = socket_address(address);
  if (::bind(made.number(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
    return socket_failure(address, "cannot bind the port", "is another program listening on it?");
  }
  if (tcp && ::listen(made.number(), SOMAXCONN) != 0) {
    return socket_failure(address, "cannot accept connections");
  }
  return made;
}

Result<Descriptor> join_group(const StreamAddress& address, const std::string& group) {
  StreamAddress place = address;
  place.host = group;
  sockaddr_in to = socket_address(place);
  if (!is_multicast(to)) {
    return usage_failure(group + " is not a multicast group: expected 224.0.0.0 to 239.255.255.255",
                         "for example: ?multicast=239.255.42.99");
  }
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  const int yes = 1;
  // Other programs on this machine may have joined the group as well.
  ::setsockopt(made.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  ip_mreq membership{};
  membership.imr_multiaddr = to.sin_addr;
  membership.imr_interface = socket_address(address).sin_addr;
  if (::bind(made.number(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 ||
      ::setsockopt(made.number(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) !=
          0) {
    return socket_failure(place, "cannot join the group",
                          "the address before the port must be this computer's network address");
  }
  return made;
}

int bound_port(const Descriptor& socket) {
  sockaddr_in place{};
  socklen_t size = sizeof place;
  ::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&place), &size);
  return ntohs(place.sin_port);
}

Result<Descriptor> connect_socket(const StreamAddress& address) {
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  const sockaddr_in place = socket_address(address);
  if (const std::string network = address.extra("interface"); !network.empty()) {
    // For a multicast group: this computer's address in the group's network.
    StreamAddress own = address;
    own.host = network;
    const in_addr from = socket_address(own).sin_addr;
    ::setsockopt(made.number(), IPPROTO_IP, IP_MULTICAST_IF, &from, sizeof from);
  }
  if (::connect(made.number(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
    return socket_failure(address, "connection failed: no answer", "start the receiver first");
  }
  return made;
}

int wait_for(std::span<const Descriptor* const> sources, double seconds) {
  constexpr std::size_t kMost = 16;
  std::array<pollfd, kMost> waiting{};
  const std::size_t count = std::min(sources.size(), kMost);
  for (std::size_t i = 0; i < count; ++i) waiting[i] = {sources[i]->number(), POLLIN, 0};
  const auto milliseconds = static_cast<int>(std::ceil(1e3 * std::clamp(seconds, 0.0, 1e3)));
  if (::poll(waiting.data(), count, milliseconds) <= 0) return -1;
  for (std::size_t i = 0; i < count; ++i) {
    if (waiting[i].revents != 0) return static_cast<int>(i);
  }
  return -1;
}

Result<Descriptor> begin_connection(const StreamAddress& address) {
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address, false));
  const sockaddr_in place = socket_address(address);
  const auto* const to = reinterpret_cast<const sockaddr*>(&place);
  if (::connect(made.number(), to, sizeof place) != 0 && errno != EINPROGRESS) {
    return run_failure(address.text(), error_text(errno));
  }
  return made;
}

std::optional<int> finish_connection(const Descriptor& socket, double seconds) {
  pollfd waiting = {socket.number(), POLLOUT, 0};
  if (::poll(&waiting, 1, static_cast<int>(std::ceil(1e3 * seconds))) <= 0) return std::nullopt;
  int failed = 0;
  socklen_t size = sizeof failed;
  ::getsockopt(socket.number(), SOL_SOCKET, SO_ERROR, &failed, &size);
  return failed;
}

ssize_t send_bytes(const Descriptor& to, std::string_view bytes, bool waits) {
  return ::send(to.number(), bytes.data(), bytes.size(), kNoSignal | (waits ? 0 : MSG_DONTWAIT));
}

ssize_t receive_bytes(const Descriptor& from, std::span<char> room) {
  return ::recv(from.number(), room.data(), room.size(), MSG_DONTWAIT);
}

std::string_view receive(const Descriptor& from, std::span<char> room, bool& ended) {
  const ssize_t count = ::read(from.number(), room.data(), room.size());
  ended = count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR && errno != ECONNREFUSED);
  return {room.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
}

void send_datagram(const Descriptor& from, const Endpoint& to, std::string_view bytes) {
  const sockaddr_in place = socket_address(to);
  static_cast<void>(::sendto(from.number(), bytes.data(), bytes.size(), kNoSignal,
                             reinterpret_cast<const sockaddr*>(&place), sizeof place));
}

std::optional<std::string_view> receive_from(const Descriptor& from, std::span<char> room,
                                             Endpoint& sender) {
  sockaddr_in place{};
  socklen_t size = sizeof place;
  const ssize_t count = ::recvfrom(from.number(), room.data(), room.size(), MSG_DONTWAIT,
                                   reinterpret_cast<sockaddr*>(&place), &size);
  if (count < 0) return std::nullopt;
  sender = endpoint(place);
  return std::string_view(room.data(), static_cast<std::size_t>(count));
}

Descriptor accept_connection(const Descriptor& listener, Endpoint& peer) {
  sockaddr_in place{};
  socklen_t size = sizeof place;
  auto* const from = reinterpret_cast<sockaddr*>(&place);
#ifdef SOCK_CLOEXEC
  const int number = ::accept4(listener.number(), from, &size, kOwn | kNonBlocking);
#else
  const int number = ::accept(listener.number(), from, &size);
#endif
  Descriptor made = own_socket(number, false);
  peer = endpoint(place);
  return made;
}

bool has_ended(const Descriptor& connection) {
  char byte = 0;
  const ssize_t count = ::recv(connection.number(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
}

bool has_input(const Descriptor& connection) {
  pollfd waiting = {connection.number(), POLLIN, 0};
  return ::poll(&waiting, 1, 0) > 0;
}

DescriptorKind descriptor_kind(const Descriptor& descriptor) {
  struct stat status {};
  if (::fstat(descriptor.number(), &status) != 0) return DescriptorKind::kOther;
  if (S_ISREG(status.st_mode)) return DescriptorKind::kFile;
  return S_ISSOCK(status.st_mode) ? DescriptorKind::kSocket : DescriptorKind::kOther;
}

ssize_t write_within(const Descriptor& to, DescriptorKind kind, std::string_view bytes,
                     std::chrono::milliseconds wait) {
  // A ready pipe accepts this many bytes at once.
  constexpr std::size_t kPipeBytes = 4096;
  if (kind != DescriptorKind::kFile) {
    pollfd ready = {to.number(), POLLOUT, 0};
    // If the reader has closed the pipe, the write below reports it.
    if (::poll(&ready, 1, static_cast<int>(wait.count())) <= 0) return 0;
  }
  ssize_t count = 0;
  switch (kind) {
    case DescriptorKind::kFile:
      count = ::write(to.number(), bytes.data(), bytes.size());
      break;
    case DescriptorKind::kSocket:
      count = send_bytes(to, bytes);
      break;
    case DescriptorKind::kOther:
      count = ::write(to.number(), bytes.data(), std::min(bytes.size(), kPipeBytes));
      break;
  }
  return count < 0 && (errno == EINTR || errno == EAGAIN) ? 0 : count;
}

void remove_last_bytes(const Descriptor& file, std::size_t count) {
  if (count == 0) return;
  const off_t end = ::lseek(file.number(), 0, SEEK_CUR);
  if (end < static_cast<off_t>(count)) return;
  const off_t begin = end - static_cast<off_t>(count);
  if (::ftruncate(file.number(), begin) == 0) ::lseek(file.number(), begin, SEEK_SET);
}

std::string error_text(int error_number) {
  return std::strerror(error_number);
}

struct WithoutSignals::Before {
  sigset_t signals{};
};

WithoutSignals::WithoutSignals() : before_(std::make_unique<Before>()) {
  sigset_t all;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before_->signals);
}

WithoutSignals::~WithoutSignals() {
  ::pthread_sigmask(SIG_SETMASK, &before_->signals, nullptr);
}

ExactWaits::ExactWaits() = default;
ExactWaits::~ExactWaits() = default;

}  // namespace retarget
