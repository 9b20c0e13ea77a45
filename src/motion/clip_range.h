#pragma once

#include <optional>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// The range that `a:b` means: frames counted from 0, b not included, as Python slices. Either
/// may be left out: the beginning, the end. An end beyond the clip means its end.
///
/// Usage errors: anything else than two whole numbers and a colon, negative numbers, a range
/// without frames, a beginning behind the clip.
[[nodiscard]] Result<FrameRange> frame_range_from_text(std::string_view text, int frame_count);

/// The frames at times from `start` to `end` seconds, both included: the first frame at or after
/// start, up to the last frame at or before end. A time within a millionth of a frame of a frame
/// counts as the frame's own, so 0.1 s is frame 3 of 30 in a second. A time left out means the
/// clip's own beginning or end; an end behind the clip means its end.
///
/// Usage errors: negative times or such as are not finite, an end before the start, a range
/// without frames, a start behind the clip.
[[nodiscard]] Result<FrameRange> frame_range_from_seconds(std::optional<double> start,
                                                          std::optional<double> end,
                                                          const FrameRate& rate, int frame_count);

/// The part of a clip that options choose, by frames or by times; nothing given: all of it. Usage
/// errors: those of the two above; frames and times both.
[[nodiscard]] Result<FrameRange> chosen_range(const PartOptions& part, const FrameRate& rate,
                                              int frame_count);

}  // namespace retarget
