#include "live/stream/byte_output.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <thread>

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

namespace {

constexpr double kConnectWithin = 1.0;                          // seconds
constexpr std::size_t kMaxWaitingBytes = std::size_t{1} << 20;  // bytes
constexpr auto kFinishWithin = std::chrono::milliseconds(300);

// One second of frames.
FrameBytesQueue::Bounds bounds_of(double fps) {
  return {static_cast<std::size_t>(std::max(1.0, std::ceil(fps))), kMaxWaitingBytes};
}

}  // namespace

Result<std::unique_ptr<FrameOutput>> open_byte_output(const StreamAddress& to,
                                                      const FrameOutputContext& context) {
  auto writer = make_frame_writer(to.format, to.file, context.robot, context.fps, context.held);
  if (to.transport == Transport::kUdp) {
    auto output = std::make_unique<DatagramOutput>(to, context, std::move(writer));
    RETARGET_TRY(output->open());
    return output;
  }
  if (to.transport == Transport::kTcp) {
    auto output = std::make_unique<ConnectionOutput>(to, context, std::move(writer));
    RETARGET_TRY(output->open());
    return output;
  }
  RETARGET_TRY_ASSIGN(Descriptor file, open_for_writing(to));
  return std::make_unique<WriterOutput>(to, std::move(file), context, std::move(writer));
}

Result<ByteSink> ByteSink::open(const StreamAddress& address) {
  ByteSink sink;
  sink.address_ = address;
  switch (address.transport) {
    case Transport::kUdp:
    case Transport::kTcp: {
      if (address.port == 0) return usage_failure(address.text() + " has no destination port");
      RETARGET_TRY_ASSIGN(sink.to_, connect_socket(address));
      break;
    }
    case Transport::kStdin:
      return usage_failure("cannot send to standard input");
    case Transport::kZmq:
    case Transport::kRedis:
      return usage_failure("cannot play a motion to " + address.text());
    case Transport::kStdout:
    case Transport::kFile: {
      RETARGET_TRY_ASSIGN(sink.to_, open_for_writing(address));
      break;
    }
  }
  sink.kind_ = descriptor_kind(sink.to_);
  return sink;
}

Result<void> ByteSink::write(std::string_view bytes, const std::function<bool()>& is_stopped) {
  constexpr auto kLook = std::chrono::milliseconds(50);
  if (address_.transport == Transport::kUdp) {
    // Ignore errors: there may be no receiver.
    static_cast<void>(send_bytes(to_, bytes, true));
    return {};
  }
  while (!bytes.empty() && !(is_stopped && is_stopped())) {
    const ssize_t count = write_within(to_, kind_, bytes, kLook);
    if (count < 0) {
      return run_failure(address_.text(), std::string("cannot be written: ") + error_text(errno));
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

DatagramOutput::DatagramOutput(const StreamAddress& to, const FrameOutputContext& /*context*/,
                               std::unique_ptr<RobotFrameWriter> writer)
    : to_(to), writer_(std::move(writer)), header_(writer_->header()) {
  statistics_.name = to.text();
}

Result<void> DatagramOutput::open() {
  RETARGET_TRY_ASSIGN(socket_, connect_socket(to_));
  if (!header_.empty()) static_cast<void>(send(header_));
  return {};
}

void DatagramOutput::take(const RobotFrame& frame) {
  constexpr int kHeaderEvery = 100;  // Frames; receivers may join at any time.
  if (!header_.empty() && frame.index % kHeaderEvery == kHeaderEvery - 1) {
    static_cast<void>(send(header_));
  }
  bytes_.clear();
  writer_->append(frame, bytes_);
  ++(send(bytes_) ? statistics_.sent : statistics_.dropped);
}

bool DatagramOutput::send(std::string_view bytes) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (send_bytes(socket_, bytes) >= 0) return true;
    if (errno == ECONNREFUSED) {
      // The error refers to the previous datagram; this one was not sent.
      statistics_.last_error = "no receiver is listening";
      if (statistics_.sent > 0) {
        --statistics_.sent;
        ++statistics_.dropped;
      }
    } else if (errno != EINTR) {
      statistics_.last_error = error_text(errno);
      return false;
    }
  }
  return false;
}

ConnectionOutput::ConnectionOutput(const StreamAddress& to, const FrameOutputContext& context,
                                   std::unique_ptr<RobotFrameWriter> writer)
    : connection_(to),
      writer_(std::move(writer)),
      account_(to.text(), context.tell),
      waiting_(bounds_of(context.fps)) {}

Result<void> ConnectionOutput::open() {
  RETARGET_TRY(connection_.open(kConnectWithin));
  begin();
  send_waiting();
  return {};
}

void ConnectionOutput::begin() {
  was_open_ = true;
  current_ = writer_->header();
  sent_of_current_ = 0;
  is_header_ = true;
}

void ConnectionOutput::take(const RobotFrame& frame) {
  connection_.retry(Clock::now());
  if (connection_.is_open() && !was_open_) {
    account_.count_reconnect();
    account_.report_recovery();
    begin();
  }
  if (!connection_.is_open()) {
    account_.count_dropped();
    return;
  }
  bytes_.clear();
  writer_->append(frame, bytes_);
  queue(bytes_);
  send_waiting();
}

void ConnectionOutput::queue(std::string_view frame) {
  while (!waiting_.has_room(frame.size())) {
    account_.report_trouble("it is more than a second behind");
    account_.count_dropped();
    waiting_.drop_oldest();
  }
  waiting_.push(frame);
}

void ConnectionOutput::send_waiting() {
  for (;;) {
    if (is_idle()) {
      if (!std::exchange(is_header_, false) && !current_.empty()) account_.count_sent();
      current_.clear();
      sent_of_current_ = 0;
      if (waiting_.empty()) {
        account_.report_recovery();
        return;
      }
      waiting_.take(current_);
    }
    const std::size_t sent = connection_.send(std::string_view(current_).substr(sent_of_current_));
    if (!connection_.is_open()) return lose();
    if (sent == 0) return;
    sent_of_current_ += sent;
  }
}

// A partially sent frame is not continued on another connection.
void ConnectionOutput::lose() {
  was_open_ = false;
  account_.report_trouble(connection_.reason());
  drop_waiting();
}

void ConnectionOutput::drop_waiting() {
  const bool has_begun = !is_idle() && !is_header_;
  account_.count_dropped(static_cast<std::int64_t>(waiting_.size()) + (has_begun ? 1 : 0));
  waiting_.clear();
  current_.clear();
  sent_of_current_ = 0;
}

void ConnectionOutput::finish() {
  const auto until = Clock::now() + kFinishWithin;
  while (connection_.is_open()) {
    send_waiting();
    if (is_idle() && waiting_.empty()) return;
    if (Clock::now() >= until) return drop_waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace retarget
