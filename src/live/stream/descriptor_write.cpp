#include "live/stream/descriptor_write.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace retarget {

DescriptorKind descriptor_kind(const Descriptor& descriptor) {
  struct stat status {};
  if (::fstat(descriptor.number(), &status) != 0) return DescriptorKind::kOther;
  if (S_ISREG(status.st_mode)) return DescriptorKind::kFile;
  return S_ISSOCK(status.st_mode) ? DescriptorKind::kSocket : DescriptorKind::kOther;
}

ssize_t write_within(const Descriptor& to, DescriptorKind kind, std::string_view bytes,
                     std::chrono::milliseconds wait) {
  // A ready pipe accepts this many bytes at once.
  constexpr std::size_t kPipeBytes = 4096;
  if (kind != DescriptorKind::kFile) {
    pollfd ready = {to.number(), POLLOUT, 0};
    // If the reader has closed the pipe, the write below reports it.
    if (::poll(&ready, 1, static_cast<int>(wait.count())) <= 0) return 0;
  }
  ssize_t count = 0;
  switch (kind) {
    case DescriptorKind::kFile:
      count = ::write(to.number(), bytes.data(), bytes.size());
      break;
    case DescriptorKind::kSocket:
      count = ::send(to.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      break;
    case DescriptorKind::kOther:
      count = ::write(to.number(), bytes.data(), std::min(bytes.size(), kPipeBytes));
      break;
  }
  return count < 0 && (errno == EINTR || errno == EAGAIN) ? 0 : count;
}

}  // namespace retarget
