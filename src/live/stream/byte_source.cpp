#include "live/stream/byte_source.h"

#include <fmt/format.h>
#include <algorithm>

#include "retarget/try.h"

namespace retarget {
namespace {

constexpr double kReleasedAfter = 1.0;  // Seconds without a datagram.

constexpr std::size_t kMaxDatagram = std::size_t{1} << 16;

}  // namespace

Result<SenderFilter> SenderFilter::parse(const std::string& text) {
  SenderFilter filter;
  if (text.empty()) return filter;
  if (text == "any") {
    filter.any = true;
    return filter;
  }
  // parse_address would interpret a port alone as a local port.
  const bool has_port = text.find(':') != std::string::npos;
  const auto address = parse_address("udp:" + text + (has_port ? "" : ":0"));
  if (!address || (has_port && address->port == 0)) {
    return usage_failure(
        "expected from=ADDRESS, from=ADDRESS:PORT or from=any, found \"" + text + "\"",
        "for example: udp:0.0.0.0:9763?from=192.168.1.20");
  }
  const Endpoint sender = endpoint_of(*address);
  filter.host = sender.host;
  if (has_port) filter.port = sender.port;
  return filter;
}

// Records a datagram from a port.
// @return whether the port had sent another one within the last second. A program that uses a new
//     port per datagram soon repeats one by chance, so a repetition among several ports that
//     have sent only once is ignored.
bool SenderLock::has_sent_recently(std::uint16_t port, double now) {
  constexpr int kMostSinglePorts = 4;
  const auto has = [&](const Port& each) { return each.datagrams > 0 && each.number == port; };
  const auto is_recent = [&](const Port& each) {
    return each.datagrams > 0 && now - each.latest < kReleasedAfter;
  };
  Port* place = std::ranges::find_if(ports_, has);
  if (place == ports_.end()) {
    const auto time = [](const Port& each) { return each.datagrams > 0 ? each.latest : -1.0; };
    place = std::ranges::min_element(ports_, {}, time);
  }
  const bool known = has(*place) && is_recent(*place);
  *place = {port, now, known ? std::min(place->datagrams + 1, 2) : 1};
  const auto single = std::ranges::count_if(
      ports_, [&](const Port& each) { return each.datagrams == 1 && is_recent(each); });
  return known && single < kMostSinglePorts;
}

SenderLock::Verdict SenderLock::judge(const Endpoint& from, double now, double earliest) {
  if (filter_.any) return Verdict::kSender;
  if (!filter_.admits(from)) return Verdict::kStranger;
  const bool is_free = !sender_ || earliest - latest_ > kReleasedAfter;
  const bool same_host = sender_ && sender_->host == from.host;
  const bool same = same_host && (any_port_ || sender_->port == from.port);
  if (!is_free && !same && (!same_host || is_steady_)) return Verdict::kStranger;
  // Another port is another program, unless the program uses a new port for every datagram.
  const bool is_new = sender_ && !same && (!same_host || is_steady_);
  // If two programs on one machine send, the first of them that sends again remains the sender.
  is_steady_ = has_sent_recently(from.port, now) || (same && is_steady_);
  sender_ = from;
  latest_ = now;
  return is_new ? Verdict::kNewSender : Verdict::kSender;
}

void EarlyDatagrams::keep(const Endpoint& from, std::string_view bytes, double now) {
  constexpr std::size_t kMostSenders = 4, kMostDatagrams = 4;
  auto place = std::ranges::find(senders_, from, &Sender::address);
  if (place == senders_.end()) {
    if (senders_.size() == kMostSenders) {
      senders_.erase(std::ranges::min_element(senders_, {}, &Sender::latest));
    }
    place = senders_.insert(senders_.end(), Sender{from, now, {}});
  }
  place->latest = now;
  if (place->datagrams.size() < kMostDatagrams) place->datagrams.emplace_back(bytes);
}

std::vector<std::string> EarlyDatagrams::take(const Endpoint& from) {
  const auto place = std::ranges::find(senders_, from, &Sender::address);
  if (place == senders_.end()) return {};
  std::vector<std::string> datagrams = std::move(place->datagrams);
  senders_.erase(place);
  return datagrams;
}

namespace {

constexpr std::size_t kMostWaiting = 8;
constexpr double kSilent = 1.0;  // seconds

}  // namespace

bool SenderConnections::is_alive(double now) const {
  return sender_.connection.is_open() && now - latest_ <= kSilent;
}

SenderConnections::Event SenderConnections::wait(double seconds, double now) {
  // Watch the waiting connections only while one of them may become the sender.
  std::array<const Descriptor*, 2 + kMostWaiting> sources = {&sender_.connection, &listener_};
  std::size_t count = 2;
  if (!is_alive(now)) {
    for (const Connection& each : waiting_) sources[count++] = &each.connection;
  }
  const int which = wait_for(std::span(sources).first(count), seconds);
  // A busy sender does not keep the listener's short queue full.
  if (which == 1 || (which == 0 && has_input(listener_))) accept();
  if (which == 0) return Event::kInput;
  if (which < 0) return Event::kIdle;
  if (is_alive(now)) return Event::kNothing;
  if (!promote()) return Event::kNothing;
  latest_ = now;
  return Event::kNewSender;
}

void SenderConnections::accept() {
  Connection made;
  made.connection = accept_connection(listener_, made.peer);
  if (!made.connection.is_open()) return;
  const bool is_admitted = filter_.admits(made.peer);
  if (!is_admitted || sender_.connection.is_open()) {
    ++strangers_;
    latest_stranger_ = made.peer;
  }
  if (!is_admitted) return;
  drop_ended();
  if (waiting_.size() == kMostWaiting) {
    // Drop the oldest connection that has sent nothing, or else the oldest one.
    const auto quiet = std::ranges::find_if(
        waiting_, [](const Connection& each) { return !has_input(each.connection); });
    waiting_.erase(quiet == waiting_.end() ? waiting_.begin() : quiet);
  }
  waiting_.push_back(std::move(made));
}

void SenderConnections::drop_ended() {
  std::erase_if(waiting_, [](const Connection& each) { return has_ended(each.connection); });
}

bool SenderConnections::promote() {
  drop_ended();
  const auto next = std::ranges::find_if(
      waiting_, [](const Connection& each) { return has_input(each.connection); });
  if (next == waiting_.end()) return false;
  std::swap(sender_, *next);
  // A sender that was only silent may continue later.
  if (!next->connection.is_open()) waiting_.erase(next);
  return true;
}

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
    source.pipe_ = standard_stream(0);
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
        fmt::format("ignoring {}: {} (choose with ?from=ADDRESS; further senders are only counted)",
                    stranger.text(),
                    sender ? sender->text() + " is the sender" : "another sender is active"));
}

ByteSource::Event ByteSource::wait(double seconds) {
  if (is_text_) {
    if (const Event event = next_line(); event != Event::kNothing) return event;
  }
  if (!early_.empty()) return next_early();
  is_early_ = false;
  if (held_back_) return give(*std::exchange(held_back_, std::nullopt));
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
  if (!lines_.next(packet_)) return Event::kNothing;
  return is_early_ ? Event::kEarlyPacket : Event::kPacket;
}

ByteSource::Event ByteSource::next_early() {
  is_early_ = true;
  early_bytes_ = std::move(early_.back());
  early_.pop_back();
  return give(early_bytes_);
}

// Takes bytes of a socket or pipe: they are a packet, or contain the first line of it.
ByteSource::Event ByteSource::give(std::string_view bytes) {
  if (!is_text_) {
    packet_ = bytes;
    if (bytes.empty()) return Event::kNothing;
    return is_early_ ? Event::kEarlyPacket : Event::kPacket;
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
  int which = wait_for(sources, 0.0);
  if (which < 0) {
    const double end = now() + seconds;
    which = wait_for(sources, seconds);
    emptied_ = std::min(now(), end);  // The machine may stop this program during the wait.
  }
  if (which < 0) return Event::kIdle;
  return take_datagram(which == 0 ? socket_ : group_);
}

ByteSource::Event ByteSource::take_datagram(const Descriptor& from) {
  constexpr int kMostStrangers = 64;  // Per call, so that other sources are served.
  for (int i = 0; i < kMostStrangers; ++i) {
    Endpoint sender;
    const auto bytes = receive_from(from, room_, sender);
    if (!bytes) return Event::kNothing;
    switch (lock_.judge(sender, now(), emptied_)) {
      case SenderLock::Verdict::kSender:
        return give(*bytes);
      case SenderLock::Verdict::kNewSender:
        held_back_ = bytes;
        early_ = strangers_.take(sender);
        std::ranges::reverse(early_);
        lines_.clear();
        return Event::kNewSender;
      case SenderLock::Verdict::kStranger:
        ++strange_datagrams_;
        strangers_.keep(sender, *bytes, now());
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
    case SenderConnections::Event::kIdle:
      return Event::kIdle;
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
  if (wait_for(sources, seconds) < 0) return Event::kIdle;
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
