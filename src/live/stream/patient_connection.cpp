#include "live/stream/patient_connection.h"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace retarget {
namespace {

constexpr auto kTryAgain = std::chrono::milliseconds(500);

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
  pollfd waiting = {socket_.number(), POLLOUT, 0};
  if (::poll(&waiting, 1, static_cast<int>(std::ceil(1e3 * seconds))) <= 0) return;
  int failed = 0;
  socklen_t size = sizeof failed;
  ::getsockopt(socket_.number(), SOL_SOCKET, SO_ERROR, &failed, &size);
  if (failed != 0) return close(std::strerror(failed));
  connected_ = true;
  reason_.clear();
}

std::size_t PatientConnection::send(std::string_view bytes) {
  if (!connected_) return 0;
  const ssize_t count = ::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (count >= 0) return static_cast<std::size_t>(count);
  if (errno != EAGAIN && errno != EINTR) close(std::strerror(errno));
  return 0;
}

std::string_view PatientConnection::receive(std::span<char> room) {
  if (!connected_) return {};
  const ssize_t count = ::recv(socket_.number(), room.data(), room.size(), 0);
  if (count > 0) return {room.data(), static_cast<std::size_t>(count)};
  if (count == 0) {
    close("the peer closed the connection");
  } else if (errno != EAGAIN && errno != EINTR) {
    close(std::strerror(errno));
  }
  return {};
}

void PatientConnection::close(std::string reason) {
  reason_ = std::move(reason);
  connected_ = false;
  socket_.close();
}

}  // namespace retarget
