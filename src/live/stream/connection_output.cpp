#include "live/stream/connection_output.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "retarget/try.h"

namespace retarget {
namespace {

using Clock = PatientConnection::Clock;

constexpr double kConnectWithin = 1.0;                          // seconds
constexpr std::size_t kMaxWaitingBytes = std::size_t{1} << 20;  // bytes
constexpr auto kFinishWithin = std::chrono::milliseconds(300);

// One second of frames.
FrameBytesQueue::Bounds bounds_of(double fps) {
  return {static_cast<std::size_t>(std::max(1.0, std::ceil(fps))), kMaxWaitingBytes};
}

}  // namespace

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
