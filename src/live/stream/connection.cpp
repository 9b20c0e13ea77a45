#include "live/stream/connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <thread>
#include <utility>

#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr auto kTryAgain = std::chrono::milliseconds(500);

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxRequest = 4096;  // bytes
constexpr std::size_t kMaxReceivers = 16;
constexpr auto kForgotten = std::chrono::seconds(10);  // Timeout of a silent receiver.

// Whether frames go to a multicast group, whose members need no separate copies.
bool is_group(const StreamAddress& to) {
  constexpr int kFirst = 224, kLast = 239;
  const auto first = parse_number<int>(to.host.substr(0, to.host.find('.')));
  return first && *first >= kFirst && *first <= kLast;
}

}  // namespace

Result<void> PatientConnection::open(double seconds) {
  begin(Clock::now());
  finish(seconds);
  if (connected_) return {};
  if (reason_.empty()) reason_ = "connection failed: no answer";
  return run_failure(address_.text(), reason_, "start the receiver first");
}

void PatientConnection::retry(Clock::time_point now) {
  if (connected_) return;
  if (!socket_.is_open() && now >= next_try_) begin(now);
  finish(0.0);
}

void PatientConnection::begin(Clock::time_point now) {
  next_try_ = now + kTryAgain;
  auto begun = begin_connection(address_);
  if (!begun) return close(std::move(begun).error().message);
  socket_ = *std::move(begun);
}

void PatientConnection::finish(double seconds) {
  if (!socket_.is_open()) return;
  const auto failed = finish_connection(socket_, seconds);
  if (!failed) return;
  if (*failed != 0) return close(error_text(*failed));
  connected_ = true;
  reason_.clear();
}

std::size_t PatientConnection::send(std::string_view bytes) {
  if (!connected_) return 0;
  const ssize_t count = send_bytes(socket_, bytes);
  if (count >= 0) return static_cast<std::size_t>(count);
  if (errno != EAGAIN && errno != EINTR) close(error_text(errno));
  return 0;
}

std::string_view PatientConnection::receive(std::span<char> room) {
  if (!connected_) return {};
  const ssize_t count = receive_bytes(socket_, room);
  if (count > 0) return {room.data(), static_cast<std::size_t>(count)};
  if (count == 0) {
    close("the peer closed the connection");
  } else if (errno != EAGAIN && errno != EINTR) {
    close(error_text(errno));
  }
  return {};
}

void PatientConnection::close(std::string reason) {
  reason_ = std::move(reason);
  connected_ = false;
  socket_.close();
}

Result<RequestServer> RequestServer::open(const StreamAddress& to, int request_port) {
  RequestServer server;
  server.to_ = to;
  server.room_.resize(kMaxRequest);
  const std::string command = to.extra("command"), network = to.extra("interface");
  // A player that sends to the loopback interface accepts requests only from there.
  std::string host = is_this_machine(to) ? "127.0.0.1" : "0.0.0.0";
  if (!network.empty()) host = network;
  RETARGET_TRY_ASSIGN(const StreamAddress own,
                      parse_address("udp:" + host + ":" +
                                    (command.empty() ? std::to_string(request_port) : command)));
  RETARGET_TRY_ASSIGN(server.socket_, bind_socket(own));
  return server;
}

void RequestServer::take_request(Encoder& encoder) {
  Endpoint sender;
  const auto request = receive_from(socket_, room_, sender);
  if (!request || request->empty()) return;
  const std::string reply = encoder.answer(*request);
  if (!reply.empty()) send_datagram(socket_, sender, reply);
  if (is_group(to_)) return;
  const auto known = std::ranges::find(receivers_, sender, &Receiver::address);
  if (known != receivers_.end()) {
    known->latest = Clock::now();
  } else if (receivers_.size() < kMaxReceivers) {
    receivers_.push_back({sender, Clock::now()});
  }
}

void RequestServer::serve(Encoder& encoder, Clock::time_point then,
                          const std::function<bool()>& is_stopped) {
  constexpr double kLook = 0.05, kWhole = 0.001;  // Seconds; polls wait for whole milliseconds.
  const std::array<const Descriptor*, 1> sources = {&socket_};
  do {
    const std::chrono::duration<double> left = then - Clock::now();
    if (left.count() > 2 * kWhole) {
      if (wait_for(sources, std::min(left.count() - kWhole, kLook)) == 0) {
        take_request(encoder);
      }
    } else {
      if (wait_for(sources, 0.0) == 0) take_request(encoder);
      std::this_thread::sleep_until(then);
    }
  } while (Clock::now() < then && !(is_stopped && is_stopped()));
}

void RequestServer::send(std::string_view bytes) {
  const auto now = Clock::now();
  std::erase_if(receivers_, [&](const Receiver& each) { return now - each.latest > kForgotten; });
  for (const Receiver& each : receivers_) {
    if (each.address != endpoint_of(to_)) send_datagram(socket_, each.address, bytes);
  }
}

}  // namespace retarget
