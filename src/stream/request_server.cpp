#include "stream/request_server.h"

#include <algorithm>
#include <string>
#include <thread>

#include "base/number_text.h"
#include "base/try.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxRequest = 4096;  // bytes
constexpr std::size_t kMaxReceivers = 16;
constexpr auto kForgotten = std::chrono::seconds(10);  // who is silent for so long

// whether frames go to a group of receivers, who need none of their own
bool is_group(const StreamAddress& to) {
  constexpr int kFirst = 224, kLast = 239;
  const auto first = parse_number<int>(to.host.substr(0, to.host.find('.')));
  return first && *first >= kFirst && *first <= kLast;
}

bool same_place(const StreamAddress& a, const StreamAddress& b) {
  return a.host == b.host && a.port == b.port;
}

}  // namespace

Result<RequestServer> RequestServer::open(const StreamAddress& to, int request_port) {
  RequestServer server;
  server.to_ = to;
  server.room_.resize(kMaxRequest);
  const std::string command = to.extra("command"), network = to.extra("interface");
  // who sends to this machine alone is asked by it alone
  std::string host = is_this_machine(to) ? "127.0.0.1" : "0.0.0.0";
  if (!network.empty()) host = network;
  TRY_ASSIGN(const StreamAddress own,
             parse_address("udp:" + host + ":" +
                           (command.empty() ? std::to_string(request_port) : command)));
  TRY_ASSIGN(server.socket_, bind_socket(own));
  return server;
}

void RequestServer::take_request(Encoder& encoder) {
  StreamAddress sender;
  const std::string_view request = receive_from(socket_, room_, sender);
  if (request.empty()) return;
  const std::string reply = encoder.answer(request);
  if (!reply.empty()) send_datagram(socket_, sender, reply);
  if (is_group(to_)) return;
  const auto known = std::ranges::find_if(
      receivers_, [&](const Receiver& each) { return same_place(each.address, sender); });
  if (known != receivers_.end()) {
    known->latest = Clock::now();
  } else if (receivers_.size() < kMaxReceivers) {
    receivers_.push_back({sender, Clock::now()});
  }
}

void RequestServer::serve(Encoder& encoder, Clock::time_point then,
                          const std::function<bool()>& is_stopped) {
  constexpr double kLook = 0.05, kWhole = 0.001;  // seconds: waiting is by whole milliseconds
  const Descriptor none;
  do {
    const std::chrono::duration<double> left = then - Clock::now();
    if (left.count() > 2 * kWhole) {
      if (wait_for(socket_, none, std::min(left.count() - kWhole, kLook)) == 0) {
        take_request(encoder);
      }
    } else {
      if (wait_for(socket_, none, 0.0) == 0) take_request(encoder);
      std::this_thread::sleep_until(then);
    }
  } while (Clock::now() < then && !(is_stopped && is_stopped()));
}

void RequestServer::send(std::string_view bytes) {
  const auto now = Clock::now();
  std::erase_if(receivers_, [&](const Receiver& each) { return now - each.latest > kForgotten; });
  for (const Receiver& each : receivers_) {
    if (!same_place(each.address, to_)) send_datagram(socket_, each.address, bytes);
  }
}

}  // namespace retarget
