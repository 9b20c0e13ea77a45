#include "live/stream/datagram_output.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "retarget/try.h"

namespace retarget {

DatagramOutput::DatagramOutput(const StreamAddress& to, const FrameOutputContext& /*context*/,
                               std::unique_ptr<RobotFrameWriter> writer)
    : to_(to), writer_(std::move(writer)), header_(writer_->header()) {
  statistics_.name = to.text();
}

Result<void> DatagramOutput::open() {
  if (to_.port == 0) return usage_failure(to_.text() + " has no destination port");
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
    if (::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0) {
      return true;
    }
    if (errno == ECONNREFUSED) {
      // The error refers to the previous datagram; this one was not sent.
      statistics_.last_error = "no receiver is listening";
      if (statistics_.sent > 0) {
        --statistics_.sent;
        ++statistics_.dropped;
      }
    } else if (errno != EINTR) {
      statistics_.last_error = std::strerror(errno);
      return false;
    }
  }
  return false;
}

}  // namespace retarget
