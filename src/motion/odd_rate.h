#pragma once

#include <optional>
#include <string>

#include "base/option_name.h"
#include "retarget/clip.h"
#include "retarget/text.h"

namespace retarget {

/// Reports a rate that no recording has, for a sentence that begins with its source; nothing if it
/// is usual or does not matter.
inline std::optional<std::string> odd_rate_text(const FrameRate& rate, int frame_count) {
  constexpr double kFewest = 6.0, kMost = 1000.0;  // Frames per second.
  const double fps = rate.fps();
  if (frame_count < 2 || (fps >= kFewest && fps <= kMost)) return std::nullopt;
  return number_text(fps, 3) + " fps and a duration of " +
         number_text(rate.time_of(frame_count - 1), 3) + " s, but recordings have " +
         number_text(kFewest, 0) + " to " + number_text(kMost, 0) +
         " fps: if it is wrong, " OPTION("source-fps") " N sets the rate";
}

}  // namespace retarget
