#pragma once

#include <memory>

#include "live/stream/frame_output.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"
#include "retarget/serve.h"

namespace retarget {

/// Opens an output. Errors: unavailable address; unknown format, or one that does not support the
/// address or this robot (kUsage).
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_frame_output(
    const StreamAddress& to, const FrameOutputContext& context);

}  // namespace retarget
