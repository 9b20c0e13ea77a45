#include "live/stream/byte_source.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "live/stream/input_address.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxDatagram = std::size_t{1} << 16;

}  // namespace

ByteSource::ByteSource(const StreamAddress& address, const StreamFormat& format, Tell tell)
    : address_(address),
      is_text_(format.is_text),
      tell_(std::move(tell)),
      room_(kMaxDatagram),
      lines_(format.datagram_lines) {}

Result<ByteSource> ByteSource::open(const StreamAddress& address, const StreamFormat& format,
                                    Tell tell) {
  RETARGET_TRY(check_input(address, format));
  ByteSource source(address, format, std::move(tell));
  if (address.transport == Transport::kStdin) {
    source.pipe_ = Descriptor(::dup(STDIN_FILENO));
  } else if (address.transport == Transport::kUdp) {
    RETARGET_TRY(source.open_datagrams(format.request_port));
  } else {
    RETARGET_TRY_ASSIGN(const SenderFilter filter, SenderFilter::parse(address.extra("from")));
    RETARGET_TRY_ASSIGN(Descriptor listener, bind_socket(address));
    source.connections_ = SenderConnections(std::move(listener), filter);
  }
  return source;
}

// The multicast group has a separate socket, which receives no datagrams sent to this machine.
Result<void> ByteSource::open_datagrams(int request_port) {
  StreamAddress own = address_;
  const std::string group = address_.extra("multicast"), server = address_.extra("server");
  RETARGET_TRY_ASSIGN(SenderFilter filter, SenderFilter::parse(address_.extra("from")));
  if (!group.empty()) {
    RETARGET_TRY_ASSIGN(group_, join_group(address_, group));
    own.port = 0;
  }
  RETARGET_TRY_ASSIGN(socket_, bind_socket(own));
  if (!server.empty()) {
    const std::string command = address_.extra("command");
    RETARGET_TRY_ASSIGN(const StreamAddress asked,
                        parse_address("udp:" + server + ":" +
                                      (command.empty() ? std::to_string(request_port) : command)));
    if (is_this_machine(own) && !is_this_machine(asked)) {
      return usage_failure(
          "the input listens on this machine only, but the server is on another machine",
          fmt::format("for example: udp:0.0.0.0:{}?server={}", address_.port, server));
    }
    server_ = endpoint_of(asked);
    if (!filter.any && !filter.host) filter.host = server_->host;
  }
  // A server answers from one port and sends frames from another.
  lock_ = SenderLock(filter, server_.has_value());
  return {};
}

int ByteSource::port() const {
  if (address_.transport == Transport::kTcp) return bound_port(connections_.listener());
  return bound_port(group_.is_open() ? group_ : socket_);
}

void ByteSource::send(std::string_view bytes) {
  if (server_) send_datagram(socket_, *server_, bytes);
}

SourceStatistics ByteSource::statistics() const {
  return {strange_datagrams_ + connections_.strangers(), lines_.dropped()};
}

double ByteSource::now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void ByteSource::report_stranger(const Endpoint& stranger) {
  if (std::exchange(is_stranger_reported_, true)) return;
  const auto sender =
      address_.transport == Transport::kTcp ? connections_.sender_peer() : lock_.sender();
  tell_("input",
        fmt::format("ignoring {}: {} (choose with ?from=ADDRESS; further ones are only counted)",
                    stranger.text(),
                    sender ? sender->text() + " is the sender" : "another sender is active"));
}

ByteSource::Event ByteSource::wait(double seconds) {
  if (held_back_) return give(*std::exchange(held_back_, std::nullopt));
  if (is_text_) {
    if (const Event event = next_line(); event != Event::kNothing) return event;
  }
  if (ended_) return Event::kEnd;
  switch (address_.transport) {
    case Transport::kUdp:
      return wait_for_datagram(seconds);
    case Transport::kTcp:
      return wait_for_connection(seconds);
    default:
      return wait_for_pipe(seconds);
  }
}

ByteSource::Event ByteSource::next_line() {
  return lines_.next(packet_) ? Event::kPacket : Event::kNothing;
}

// Takes bytes of a socket or pipe: they are a packet, or contain the first line of it.
ByteSource::Event ByteSource::give(std::string_view bytes) {
  if (!is_text_) {
    packet_ = bytes;
    return bytes.empty() ? Event::kNothing : Event::kPacket;
  }
  if (address_.transport == Transport::kUdp) {
    lines_.add_datagram(bytes);
  } else {
    lines_.add(bytes);
  }
  return next_line();
}

ByteSource::Event ByteSource::wait_for_datagram(double seconds) {
  const std::array<const Descriptor*, 2> sources = {&socket_, &group_};
  const int which = wait_for(sources, seconds);
  if (which < 0) return Event::kNothing;
  return take_datagram(which == 0 ? socket_ : group_);
}

ByteSource::Event ByteSource::take_datagram(const Descriptor& from) {
  constexpr int kMostStrangers = 64;  // Per call, so that other sources are served.
  for (int i = 0; i < kMostStrangers; ++i) {
    Endpoint sender;
    const auto bytes = receive_from(from, room_, sender);
    if (!bytes) return Event::kNothing;
    switch (lock_.judge(sender, now())) {
      case SenderLock::Verdict::kSender:
        return give(*bytes);
      case SenderLock::Verdict::kNewSender:
        held_back_ = bytes;
        lines_.clear();
        return Event::kNewSender;
      case SenderLock::Verdict::kStranger:
        ++strange_datagrams_;
        report_stranger(sender);
        break;
    }
  }
  return Event::kNothing;
}

ByteSource::Event ByteSource::wait_for_connection(double seconds) {
  const std::int64_t strangers = connections_.strangers();
  const SenderConnections::Event event = connections_.wait(seconds, now());
  if (connections_.strangers() > strangers) report_stranger(connections_.latest_stranger());
  switch (event) {
    case SenderConnections::Event::kNothing:
      return Event::kNothing;
    case SenderConnections::Event::kNewSender:
      lines_.clear();
      return Event::kNewSender;
    case SenderConnections::Event::kInput:
      break;
  }
  connections_.note_input(now());
  bool ended = false;
  const Event taken = take_piece(connections_.sender(), ended);
  if (ended) connections_.close_sender();
  return taken;
}

ByteSource::Event ByteSource::wait_for_pipe(double seconds) {
  const std::array<const Descriptor*, 1> sources = {&pipe_};
  if (wait_for(sources, seconds) < 0) return Event::kNothing;
  const Event taken = take_piece(pipe_, ended_);
  return ended_ && taken == Event::kNothing ? Event::kEnd : taken;
}

ByteSource::Event ByteSource::take_piece(const Descriptor& from, bool& ended) {
  const std::string_view bytes = receive(from, room_, ended);
  if (!ended) return give(bytes);
  lines_.end();
  return is_text_ ? next_line() : Event::kNothing;
}

}  // namespace retarget
