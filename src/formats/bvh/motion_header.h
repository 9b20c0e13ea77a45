#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "formats/bvh/source_text.h"
#include "retarget/error.h"

namespace retarget {

/// The lines between MOTION and the first row.
struct MotionHeader {
  std::int64_t frames = 0;
  std::size_t frames_place = 0;      ///< Byte offset of the frame count.
  std::optional<double> frame_time;  ///< Seconds, as written; may be zero or negative.
};

/// Parses `Frames:` and `Frame Time:`, in either order, from after MOTION up to the first row.
/// @param needs_frame_time  whether a missing or non-positive frame time is an error.
[[nodiscard]] Result<MotionHeader> parse_motion_header(const SourceText& source, Scanner& scanner,
                                                       bool needs_frame_time);

}  // namespace retarget
