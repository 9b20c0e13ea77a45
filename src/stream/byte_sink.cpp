#include "stream/byte_sink.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/file.h"
#include "base/try.h"

namespace retarget {

Result<ByteSink> ByteSink::open(const StreamAddress& address) {
  ByteSink sink;
  sink.address_ = address;
  switch (address.transport) {
    case Transport::kUdp:
    case Transport::kTcp: {
      if (address.port == 0) return usage_failure(address.text() + " has no port to send to");
      TRY_ASSIGN(sink.to_, connect_socket(address));
      break;
    }
    case Transport::kStdout:
      sink.to_ = Descriptor(::dup(STDOUT_FILENO));
      break;
    case Transport::kStdin:
      return usage_failure("nothing can be sent to standard input");
    case Transport::kZmq:
    case Transport::kRedis:
      return usage_failure("a motion is not played to " + address.text());
    case Transport::kFile: {
      TRY(check_output_folder(address.file));
      constexpr int kMode = 0644;
      sink.to_ =
          Descriptor(::open(address.file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode));
      if (!sink.to_.is_open()) {
        return run_failure(address.file, std::string("cannot be written: ") + std::strerror(errno));
      }
      break;
    }
  }
  return sink;
}

Result<void> ByteSink::write(std::string_view bytes) {
  const bool datagram = address_.transport == Transport::kUdp;
  while (!bytes.empty()) {
    const ssize_t count = datagram ? ::send(to_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                   : ::write(to_.number(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    // nobody listens yet, or any more
    if (count < 0 && datagram) return {};
    if (count < 0) {
      return run_failure(address_.text(),
                         std::string("cannot be written: ") + std::strerror(errno));
    }
    if (datagram) return {};
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

}  // namespace retarget
