#include "stream/byte_source.h"

#include <fmt/format.h>
#include <unistd.h>

#include <utility>

#include "base/try.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxDatagram = std::size_t{1} << 16;
constexpr std::size_t kMaxWaiting = std::size_t{1} << 20;  // bytes of a line without an end

}  // namespace

Result<ByteSource> ByteSource::open(const StreamAddress& address, bool lines, int request_port) {
  ByteSource source;
  source.address_ = address;
  source.lines_ = lines;
  source.room_.resize(kMaxDatagram);
  if (address.transport == Transport::kStdin) {
    source.connection_ = Descriptor(::dup(STDIN_FILENO));
  } else if (address.transport == Transport::kUdp) {
    TRY(source.open_datagrams(request_port));
  } else if (address.transport == Transport::kTcp) {
    TRY_ASSIGN(source.socket_, bind_socket(address));
  } else {
    return usage_failure("a stream comes from udp:PORT, tcp:PORT or stdin, not from " +
                         address.text());
  }
  return source;
}

// A group's datagrams have a socket of their own, which takes none that are sent to this machine.
Result<void> ByteSource::open_datagrams(int request_port) {
  StreamAddress own = address_;
  const std::string group = address_.extra("multicast"), server = address_.extra("server");
  if (!group.empty()) {
    TRY_ASSIGN(connection_, join_group(address_, group));
    group_ = true;
    own.port = 0;
  }
  TRY_ASSIGN(socket_, bind_socket(own));
  if (server.empty()) return {};
  if (request_port == 0)
    return usage_failure("senders of this format cannot be asked: no ?server=");
  const std::string command = address_.extra("command");
  TRY_ASSIGN(server_, parse_address("udp:" + server + ":" +
                                    (command.empty() ? std::to_string(request_port) : command)));
  if (is_this_machine(own) && !is_this_machine(*server_)) {
    return usage_failure("the input listens to this machine alone, and the server is another one",
                         fmt::format("as in udp:0.0.0.0:{}?server={}", address_.port, server));
  }
  return {};
}

void ByteSource::send(std::string_view bytes) {
  if (server_) send_datagram(socket_, *server_, bytes);
}

// @return whether packet_ is the next line
bool ByteSource::take_line(bool last) {
  while (taken_ < waiting_.size()) {
    std::size_t end = waiting_.find('\n', taken_);
    if (end == std::string::npos) {
      if (!last) break;
      end = waiting_.size();
    }
    const std::string_view line = std::string_view(waiting_).substr(taken_, end - taken_);
    taken_ = end + 1;
    if (std::exchange(skips_, false)) continue;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    packet_ = line;
    return true;
  }
  waiting_.erase(0, std::min(taken_, waiting_.size()));
  taken_ = 0;
  if (waiting_.size() > kMaxWaiting) {
    waiting_.clear();
    skips_ = true;
    ++overlong_;
  }
  return false;
}

ByteSource::Event ByteSource::take_bytes(const Descriptor& from) {
  bool ended = false;
  const std::string_view bytes = receive(from, room_, ended);
  datagram_ = address_.transport == Transport::kUdp;
  if (datagram_) ended = false;  // an empty datagram
  if (!bytes.empty() && !lines_) {
    packet_ = bytes;
    return Event::kPacket;
  }
  waiting_.append(bytes);
  if (ended) {
    ended_ = address_.transport == Transport::kStdin;
    connection_.close();
  }
  if (take_line(datagram_ || ended)) return Event::kPacket;
  return ended_ ? Event::kEnd : Event::kNothing;
}

ByteSource::Event ByteSource::wait(double seconds) {
  if (lines_ && take_line(datagram_ || ended_)) return Event::kPacket;
  if (ended_) return Event::kEnd;
  const int which = wait_for(socket_, connection_, seconds);
  if (which == 1) return take_bytes(connection_);
  if (which != 0) return Event::kNothing;
  if (address_.transport == Transport::kUdp) return take_bytes(socket_);
  // whoever connects last is the sender
  connection_ = accept_connection(socket_);
  waiting_.clear();
  taken_ = 0;
  return Event::kNewSender;
}

}  // namespace retarget
