#pragma once

#include <memory>
#include <string_view>

#include "live/stream/frame_output.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Opens `zmq:PORT` and `redis:PORT`. Errors: those of open_frame_output; a build without the
/// library (kUsage).
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_zmq_output(
    const StreamAddress& to, const FrameOutputContext& context);
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_redis_output(
    const StreamAddress& to, const FrameOutputContext& context);
/// Whether this build supports them.
[[nodiscard]] bool has_zmq_output();
[[nodiscard]] bool has_redis_output();

/// The error of a build without a library.
[[nodiscard]] Failure lacks_library(const StreamAddress& to, std::string_view library,
                                    std::string_view package);

}  // namespace retarget
