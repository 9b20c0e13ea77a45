#pragma once

#include <memory>

#include "live/stream/frame_output.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Sends robot frames as JSON lines or CSV to datagrams, a connection, a file or standard output.
/// Errors: unavailable address; unwritable file.
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_byte_output(
    const StreamAddress& to, const FrameOutputContext& context);

}  // namespace retarget
