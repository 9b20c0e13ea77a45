#include <algorithm>
#include <array>
#include <utility>

#include "live/stream/senders.h"

namespace retarget {
namespace {

constexpr double kReleasedAfter = 1.0;  // Seconds without a datagram.

}  // namespace

Result<SenderFilter> SenderFilter::parse(const std::string& text) {
  SenderFilter filter;
  if (text.empty()) return filter;
  if (text == "any") {
    filter.any = true;
    return filter;
  }
  // parse_address would take a port alone as a local port.
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
// @return whether the port had sent another one within the last second
bool SenderLock::has_sent_lately(std::uint16_t port, double now) {
  const auto has = [&](const Port& each) { return each.is_used && each.number == port; };
  Port* place = std::ranges::find_if(ports_, has);
  if (place == ports_.end()) {
    const auto age = [](const Port& each) { return each.is_used ? each.latest : -1.0; };
    place = std::ranges::min_element(ports_, {}, age);
  }
  const bool known = has(*place) && now - place->latest < kReleasedAfter;
  *place = {port, now, true};
  return known;
}

SenderLock::Verdict SenderLock::judge(const Endpoint& from, double now) {
  if (filter_.any) return Verdict::kSender;
  if (!filter_.admits(from)) return Verdict::kStranger;
  const bool is_free = !sender_ || now - latest_ > kReleasedAfter;
  const bool same_host = sender_ && sender_->host == from.host;
  const bool same = same_host && (any_port_ || sender_->port == from.port);
  if (!is_free && !same && (!same_host || is_steady_)) return Verdict::kStranger;
  const bool is_new_host = sender_ && !same_host;
  // If two programs on one machine send, the first of them that sends again remains the sender.
  is_steady_ = has_sent_lately(from.port, now) || same;
  sender_ = from;
  latest_ = now;
  return is_new_host ? Verdict::kNewSender : Verdict::kSender;
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
  if (which == 0) return Event::kInput;
  if (which == 1) accept();
  if (which < 0 || is_alive(now)) return Event::kNothing;
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

}  // namespace retarget
