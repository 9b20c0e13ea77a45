#include "live/stream/byte_sink.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "base/try.h"
#include "live/stream/writer_output.h"

namespace retarget {

Result<ByteSink> ByteSink::open(const StreamAddress& address) {
  ByteSink sink;
  sink.address_ = address;
  switch (address.transport) {
    case Transport::kUdp:
    case Transport::kTcp: {
      if (address.port == 0) return usage_failure(address.text() + " has no destination port");
      TRY_ASSIGN(sink.to_, connect_socket(address));
      break;
    }
    case Transport::kStdin:
      return usage_failure("cannot send to standard input");
    case Transport::kZmq:
    case Transport::kRedis:
      return usage_failure("cannot play a motion to " + address.text());
    case Transport::kStdout:
    case Transport::kFile: {
      TRY_ASSIGN(sink.to_, open_for_writing(address));
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
    static_cast<void>(::send(to_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
    return {};
  }
  while (!bytes.empty() && !(is_stopped && is_stopped())) {
    const ssize_t count = write_within(to_, kind_, bytes, kLook);
    if (count < 0) {
      return run_failure(address_.text(),
                         std::string("cannot be written: ") + std::strerror(errno));
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

}  // namespace retarget
