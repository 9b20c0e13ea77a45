#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bvh/source_text.h"
#include "retarget/error.h"

namespace retarget {

/// What stands between MOTION and the first row.
struct MotionHeader {
  std::int64_t frames = 0;
  std::size_t frames_place = 0;      ///< Byte offset of the number of frames.
  std::optional<double> frame_time;  ///< Seconds; as written, so perhaps not positive.
};

/// Reads `Frames:` and `Frame Time:`, in either order, from behind MOTION up to the first row.
/// @param needs_frame_time  whether a missing or not positive frame time is an error.
[[nodiscard]] Result<MotionHeader> parse_motion_header(const SourceText& source, Scanner& scanner,
                                                       bool needs_frame_time);

}  // namespace retarget
