#include <sys/socket.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "live/stream/byte_output.h"
#include "live/stream/connection_output.h"
#include "live/stream/datagram_output.h"
#include "live/stream/robot_frame_writer.h"
#include "live/stream/writer_output.h"
#include "retarget/try.h"

namespace retarget {

Result<std::unique_ptr<FrameOutput>> open_byte_output(const StreamAddress& to,
                                                      const FrameOutputContext& context) {
  auto writer = make_frame_writer(to.format, to.file, context.robot, context.fps, context.held);
  if (to.transport == Transport::kUdp) {
    RETARGET_TRY(check_extras(to, std::array<std::string, 1>{"interface"}));
    auto output = std::make_unique<DatagramOutput>(to, context, std::move(writer));
    RETARGET_TRY(output->open());
    return output;
  }
  RETARGET_TRY(check_extras(to, {}));
  if (to.transport == Transport::kTcp) {
    if (to.port == 0) return usage_failure(to.text() + " has no destination port");
    auto output = std::make_unique<ConnectionOutput>(to, context, std::move(writer));
    RETARGET_TRY(output->open());
    return output;
  }
  if (to.transport == Transport::kStdin) {
    return usage_failure("cannot send to standard input");
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
