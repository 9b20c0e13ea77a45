// Sockets of Windows. All of them are non-blocking: Windows has no flag for a single call.

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX 1
#include <winsock2.h>

#include <mmsystem.h>
#include <mstcpip.h>
#include <ws2tcpip.h>

#include <io.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <thread>

#include "live/stream/socket.h"
#include "live/stream/socket_address.h"
#include "retarget/os.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestConnecting = 20.0;         // seconds
constexpr DWORD kUdpConnectionReset = 0x9800000cU;  // SIO_UDP_CONNRESET, which MinGW lacks.

int errno_of_winsock(int error) {
  switch (error) {
    case WSAEWOULDBLOCK:
    case WSAEINPROGRESS:
      return EAGAIN;
    case WSAEINTR:
      return EINTR;
    case WSAECONNREFUSED:
      return ECONNREFUSED;
    case WSAECONNRESET:
    case WSAENETRESET:
      return ECONNRESET;
    case WSAECONNABORTED:
    case WSAESHUTDOWN:
      return EPIPE;
    case WSAEADDRINUSE:
      return EADDRINUSE;
    case WSAEADDRNOTAVAIL:
      return EADDRNOTAVAIL;
    case WSAETIMEDOUT:
      return ETIMEDOUT;
    case WSAENETUNREACH:
      return ENETUNREACH;
    case WSAEHOSTUNREACH:
      return EHOSTUNREACH;
    case WSAEMSGSIZE:
      return EMSGSIZE;
    case WSAEACCES:
      return EACCES;
    case WSAENOBUFS:
      return ENOBUFS;
    default:
      return EIO;
  }
}

// Sets errno and returns the result of a failed call.
int socket_failed() {
  errno = errno_of_winsock(::WSAGetLastError());
  return -1;
}

SOCKET handle_of(const Descriptor& socket) {
  return static_cast<SOCKET>(socket.number());
}

void begin_network() {
  static const bool begun = [] {
    WSADATA data{};
    return ::WSAStartup(MAKEWORD(2, 2), &data) == 0;
  }();
  static_cast<void>(begun);
}

const sockaddr* as_any(const sockaddr_in& place) {
  return reinterpret_cast<const sockaddr*>(&place);
}

template <typename Value>
void set_option(const Descriptor& socket, int level, int name, const Value& value) {
  ::setsockopt(handle_of(socket), level, name, reinterpret_cast<const char*>(&value), sizeof value);
}

// Handle numbers have at most 32 bits.
Descriptor own_socket(SOCKET handle) {
  if (handle == INVALID_SOCKET) {
    socket_failed();
    return {};
  }
  u_long yes = 1;
  ::ioctlsocket(handle, FIONBIO, &yes);
  ::SetHandleInformation(reinterpret_cast<HANDLE>(handle), HANDLE_FLAG_INHERIT, 0);
  return Descriptor::of_socket(static_cast<int>(handle));
}

Result<Descriptor> open_socket(const StreamAddress& address) {
  begin_network();
  const bool udp = address.transport == Transport::kUdp;
  Descriptor made = own_socket(::socket(AF_INET, udp ? SOCK_DGRAM : SOCK_STREAM, 0));
  if (!made.is_open()) return socket_failure(address, "cannot create a socket");
  if (udp) {
    // Otherwise, a receiver that has ended makes the next call for any other datagram fail.
    BOOL report = FALSE;
    DWORD bytes = 0;
    ::WSAIoctl(handle_of(made), kUdpConnectionReset, &report, sizeof report, nullptr, 0, &bytes,
               nullptr, nullptr);
  } else {
    // Send each frame at once.
    set_option(made, IPPROTO_TCP, TCP_NODELAY, int{1});
  }
  return made;
}

timeval time_of(double seconds) {
  const double whole = std::floor(seconds);
  return {static_cast<long>(whole), static_cast<long>(1e6 * (seconds - whole))};
}

// Waits for one of several sockets; if `writes`, until it accepts bytes.
bool select_sockets(fd_set& set, fd_set* failed, bool writes, double seconds) {
  timeval within = time_of(seconds);
  return ::select(0, writes ? nullptr : &set, writes ? &set : nullptr, failed, &within) > 0;
}

bool is_ready(const Descriptor& socket, bool writes, double seconds) {
  fd_set set;
  FD_ZERO(&set);
  FD_SET(handle_of(socket), &set);
  return select_sockets(set, nullptr, writes, seconds);
}

// Whether a read of a pipe, a file or a terminal would not wait.
bool has_bytes(const Descriptor& file) {
  const auto handle = reinterpret_cast<HANDLE>(::_get_osfhandle(file.number()));
  if (::GetFileType(handle) != FILE_TYPE_PIPE) return true;
  DWORD available = 0;
  // Without a writer, the next read finds the end.
  return !::PeekNamedPipe(handle, nullptr, 0, nullptr, &available, nullptr) || available > 0;
}

}  // namespace

void Descriptor::close() {
  if (is_open() && is_socket_) ::closesocket(handle_of(*this));
  if (is_open() && !is_socket_) os::close_file(number_);
  number_ = -1;
}

Descriptor standard_stream(int number) {
  return Descriptor(::_dup(number));
}

Result<Descriptor> bind_socket(const StreamAddress& address) {
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  const bool tcp = address.transport == Transport::kTcp;
  // SO_REUSEADDR of Windows would let another program take the port.
  set_option(made, SOL_SOCKET, SO_EXCLUSIVEADDRUSE, int{1});
  const sockaddr_in place = socket_address(address);
  if (::bind(handle_of(made), as_any(place), sizeof place) != 0) {
    socket_failed();
    return socket_failure(address, "cannot bind the port", "is another program listening on it?");
  }
  if (tcp && ::listen(handle_of(made), SOMAXCONN) != 0) {
    socket_failed();
    return socket_failure(address, "cannot accept connections");
  }
  return made;
}

Result<Descriptor> join_group(const StreamAddress& address, const std::string& group) {
  StreamAddress place = address;
  place.host = group;
  const sockaddr_in to = socket_address(place);
  if (!is_multicast(to)) {
    return usage_failure(group + " is not a multicast group: expected 224.0.0.0 to 239.255.255.255",
                         "for example: ?multicast=239.255.42.99");
  }
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  // Other programs on this machine may have joined the group as well.
  set_option(made, SOL_SOCKET, SO_REUSEADDR, int{1});
  ip_mreq membership{};
  membership.imr_multiaddr = to.sin_addr;
  membership.imr_interface = socket_address(address).sin_addr;
  // Windows binds to addresses of this computer only.
  sockaddr_in own = to;
  own.sin_addr.s_addr = INADDR_ANY;
  if (::bind(handle_of(made), as_any(own), sizeof own) != 0 ||
      ::setsockopt(handle_of(made), IPPROTO_IP, IP_ADD_MEMBERSHIP,
                   reinterpret_cast<const char*>(&membership), sizeof membership) != 0) {
    socket_failed();
    return socket_failure(place, "cannot join the group",
                          "the address before the port must be this computer's network address");
  }
  return made;
}

int bound_port(const Descriptor& socket) {
  sockaddr_in place{};
  int size = sizeof place;
  ::getsockname(handle_of(socket), reinterpret_cast<sockaddr*>(&place), &size);
  return ::ntohs(place.sin_port);
}

Result<Descriptor> begin_connection(const StreamAddress& address) {
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  const sockaddr_in place = socket_address(address);
  if (::connect(handle_of(made), as_any(place), sizeof place) != 0 && socket_failed() != 0 &&
      errno != EAGAIN) {
    return run_failure(address.text(), error_text(errno));
  }
  return made;
}

std::optional<int> finish_connection(const Descriptor& socket, double seconds) {
  fd_set ready, failed;
  FD_ZERO(&ready);
  FD_SET(handle_of(socket), &ready);
  failed = ready;
  if (!select_sockets(ready, &failed, true, seconds)) return std::nullopt;
  int error = 0, size = sizeof error;
  ::getsockopt(handle_of(socket), SOL_SOCKET, SO_ERROR, reinterpret_cast<char*>(&error), &size);
  return error == 0 ? 0 : errno_of_winsock(error);
}

Result<Descriptor> connect_socket(const StreamAddress& address) {
  RETARGET_TRY_ASSIGN(Descriptor made, open_socket(address));
  const sockaddr_in place = socket_address(address);
  if (const std::string network = address.extra("interface"); !network.empty()) {
    // For a multicast group: this computer's address in the group's network.
    StreamAddress own = address;
    own.host = network;
    set_option(made, IPPROTO_IP, IP_MULTICAST_IF, socket_address(own).sin_addr);
  }
  int error = 0;
  if (::connect(handle_of(made), as_any(place), sizeof place) != 0) {
    socket_failed();
    error =
        errno == EAGAIN ? finish_connection(made, kLongestConnecting).value_or(ETIMEDOUT) : errno;
  }
  if (error == 0) return made;
  errno = error;
  return socket_failure(address, "connection failed: no answer", "start the receiver first");
}

int wait_for(std::span<const Descriptor* const> sources, double seconds) {
  constexpr double kMost = 1e3, kLook = 0.001;
  const auto until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(std::clamp(seconds, 0.0, kMost)));
  for (;;) {
    const std::chrono::duration<double> left = until - Clock::now();
    fd_set set;
    FD_ZERO(&set);
    bool all_sockets = true;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const Descriptor& source = *sources[i];
      if (!source.is_open()) continue;
      if (source.is_socket()) {
        FD_SET(handle_of(source), &set);
      } else if (has_bytes(source)) {
        return static_cast<int>(i);
      } else {
        all_sockets = false;
      }
    }
    const double wait = std::max(0.0, all_sockets ? left.count() : std::min(kLook, left.count()));
    if (set.fd_count == 0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(wait));
    } else if (select_sockets(set, nullptr, false, wait)) {
      for (std::size_t i = 0; i < sources.size(); ++i) {
        const Descriptor& source = *sources[i];
        if (source.is_open() && source.is_socket() && FD_ISSET(handle_of(source), &set)) {
          return static_cast<int>(i);
        }
      }
    }
    if (Clock::now() >= until) return -1;
  }
}

ssize_t send_bytes(const Descriptor& to, std::string_view bytes, bool waits) {
  constexpr double kLook = 0.05;
  if (waits) static_cast<void>(is_ready(to, true, kLook));
  const int count = ::send(handle_of(to), bytes.data(), static_cast<int>(bytes.size()), 0);
  return count < 0 ? socket_failed() : count;
}

ssize_t receive_bytes(const Descriptor& from, std::span<char> room) {
  const int count = ::recv(handle_of(from), room.data(), static_cast<int>(room.size()), 0);
  return count < 0 ? socket_failed() : count;
}

std::string_view receive(const Descriptor& from, std::span<char> room, bool& ended) {
  const ssize_t count = from.is_socket() ? receive_bytes(from, room)
                                         : os::read_bytes(from.number(), room.data(), room.size());
  ended = count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR && errno != ECONNREFUSED);
  return {room.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
}

void send_datagram(const Descriptor& from, const Endpoint& to, std::string_view bytes) {
  const sockaddr_in place = socket_address(to);
  static_cast<void>(::sendto(handle_of(from), bytes.data(), static_cast<int>(bytes.size()), 0,
                             as_any(place), sizeof place));
}

std::optional<std::string_view> receive_from(const Descriptor& from, std::span<char> room,
                                             Endpoint& sender) {
  sockaddr_in place{};
  int size = sizeof place;
  const int count = ::recvfrom(handle_of(from), room.data(), static_cast<int>(room.size()), 0,
                               reinterpret_cast<sockaddr*>(&place), &size);
  if (count < 0) return std::nullopt;
  sender = endpoint(place);
  return std::string_view(room.data(), static_cast<std::size_t>(count));
}

Descriptor accept_connection(const Descriptor& listener, Endpoint& peer) {
  sockaddr_in place{};
  int size = sizeof place;
  Descriptor made =
      own_socket(::accept(handle_of(listener), reinterpret_cast<sockaddr*>(&place), &size));
  peer = endpoint(place);
  return made;
}

bool has_ended(const Descriptor& connection) {
  char byte = 0;
  const int count = ::recv(handle_of(connection), &byte, 1, MSG_PEEK);
  if (count < 0) socket_failed();
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
}

bool has_input(const Descriptor& connection) {
  return is_ready(connection, false, 0.0);
}

DescriptorKind descriptor_kind(const Descriptor& descriptor) {
  if (descriptor.is_socket()) return DescriptorKind::kSocket;
  const auto status = os::status_of(descriptor.number());
  const bool file = status && status->kind == os::EntryKind::kRegular;
  return file ? DescriptorKind::kFile : DescriptorKind::kOther;
}

ssize_t write_within(const Descriptor& to, DescriptorKind kind, std::string_view bytes,
                     std::chrono::milliseconds wait) {
  // Windows does not report the state of a pipe, so the call waits for its reader.
  constexpr std::size_t kPipeBytes = 4096;
  ssize_t count = 0;
  if (kind == DescriptorKind::kSocket) {
    if (!is_ready(to, true, std::chrono::duration<double>(wait).count())) return 0;
    count = send_bytes(to, bytes);
  } else {
    const std::size_t size = kind == DescriptorKind::kFile ? bytes.size() : kPipeBytes;
    count = os::write_bytes(to.number(), bytes.data(), std::min(bytes.size(), size));
  }
  return count < 0 && (errno == EINTR || errno == EAGAIN) ? 0 : count;
}

void remove_last_bytes(const Descriptor& file, std::size_t count) {
  const std::int64_t end = ::_telli64(file.number());
  const std::int64_t begin = end - static_cast<std::int64_t>(count);
  if (count == 0 || begin < 0) return;
  if (os::resize_file(file.number(), begin) == 0) ::_lseeki64(file.number(), begin, SEEK_SET);
}

std::string error_text(int error_number) {
  // The C library has no messages for these errors.
  switch (error_number) {
    case EAGAIN:
      return "Resource temporarily unavailable";
    case ECONNREFUSED:
      return "Connection refused";
    case ECONNRESET:
      return "Connection reset by peer";
    case EADDRINUSE:
      return "Address already in use";
    case EADDRNOTAVAIL:
      return "Cannot assign requested address";
    case ETIMEDOUT:
      return "Connection timed out";
    case ENETUNREACH:
      return "Network is unreachable";
    case EHOSTUNREACH:
      return "No route to host";
    case EMSGSIZE:
      return "Message too long";
    default:
      return std::strerror(error_number);
  }
}

struct WithoutSignals::Before {};
WithoutSignals::WithoutSignals() = default;
WithoutSignals::~WithoutSignals() = default;

ExactWaits::ExactWaits() {
  ::timeBeginPeriod(1);
}

ExactWaits::~ExactWaits() {
  ::timeEndPeriod(1);
}

}  // namespace retarget
