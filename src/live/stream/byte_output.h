#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "live/stream/descriptor_write.h"
#include "live/stream/frame_output.h"
#include "live/stream/socket.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Sends robot frames as JSON lines or CSV to datagrams, a connection, a file or standard output.
/// Errors: unavailable address; unwritable file.
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_byte_output(
    const StreamAddress& to, const FrameOutputContext& context);

/// Destination of a player's bytes: datagrams, a connection, standard output, or a file. Waits for
/// slow receivers.
class ByteSink {
 public:
  /// Errors: unavailable address; unwritable file.
  [[nodiscard]] static Result<ByteSink> open(const StreamAddress& address);

  /// Sends a datagram, or the next bytes; waits until they are written or it is stopped. Datagrams
  /// without a receiver are not an error.
  [[nodiscard]] Result<void> write(std::string_view bytes, const std::function<bool()>& is_stopped);
  [[nodiscard]] const StreamAddress& address() const { return address_; }

 private:
  StreamAddress address_;
  Descriptor to_;
  DescriptorKind kind_ = DescriptorKind::kOther;
};

}  // namespace retarget
