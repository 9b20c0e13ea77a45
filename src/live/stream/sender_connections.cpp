#include "live/stream/sender_connections.h"

#include <algorithm>
#include <array>
#include <utility>

namespace retarget {
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
