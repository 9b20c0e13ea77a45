#include "live/stream/byte_output.h"

#include <array>
#include <string>
#include <utility>

#include "base/try.h"
#include "live/stream/connection_output.h"
#include "live/stream/datagram_output.h"
#include "live/stream/robot_frame_writer.h"
#include "live/stream/writer_output.h"

namespace retarget {

Result<std::unique_ptr<FrameOutput>> open_byte_output(const StreamAddress& to,
                                                      const FrameOutputContext& context) {
  auto writer = make_frame_writer(to.format, to.file, context.robot, context.fps, context.held);
  if (to.transport == Transport::kUdp) {
    TRY(check_extras(to, std::array<std::string, 1>{"interface"}));
    auto output = std::make_unique<DatagramOutput>(to, context, std::move(writer));
    TRY(output->open());
    return output;
  }
  TRY(check_extras(to, {}));
  if (to.transport == Transport::kTcp) {
    if (to.port == 0) return usage_failure(to.text() + " has no destination port");
    auto output = std::make_unique<ConnectionOutput>(to, context, std::move(writer));
    TRY(output->open());
    return output;
  }
  if (to.transport == Transport::kStdin) {
    return usage_failure("cannot send to standard input");
  }
  TRY_ASSIGN(Descriptor file, open_for_writing(to));
  return std::make_unique<WriterOutput>(to, std::move(file), context, std::move(writer));
}

}  // namespace retarget
