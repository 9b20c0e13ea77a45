#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "live/stream/frame_output.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// A stream format for robot frames.
struct OutputFormat {
  std::string_view name;         ///< `jsonl`, `sonic`
  std::string_view description;  ///< Human-readable, one line.
  std::string_view places;       ///< Supported addresses, human-readable.
  int port = 0;                  ///< Default port of its readers; 0: none.
  std::string_view lacks;        ///< Library missing in this build; empty: none.
};

/// All output formats.
[[nodiscard]] std::span<const OutputFormat> output_formats();

/// Opens an output. Errors: unavailable address; unknown format, or one that does not support the
/// address or this robot (kUsage).
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_frame_output(
    const StreamAddress& to, const FrameOutputContext& context);

}  // namespace retarget
