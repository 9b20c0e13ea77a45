#pragma once

#include <optional>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Parses a range `a:b`: frames counted from 0, b excluded, as in Python slices. Either number may
/// be omitted and then means the beginning or the end. An end beyond the clip means its end.
///
/// Usage errors: text that is not two integers and a colon, negative numbers, an empty range, a
/// beginning beyond the clip.
[[nodiscard]] Result<FrameRange> frame_range_from_text(std::string_view text, int frame_count);

/// The frames from `start` to `end` seconds, both included: from the first frame at or after
/// `start` to the last frame at or before `end`. Times within a millionth of a frame period of a
/// frame count as that frame, so 0.1 s is frame 3 at 30 frames per second. An omitted time means
/// the clip's beginning or end; an end beyond the clip means its end.
///
/// Usage errors: negative or non-finite times, an end before the start, an empty range, a start
/// beyond the clip.
[[nodiscard]] Result<FrameRange> frame_range_from_seconds(std::optional<double> start,
                                                          std::optional<double> end,
                                                          const FrameRate& rate, int frame_count);

/// The part of a clip that the options select, by frames or by times; all of it if they select
/// nothing. Usage errors: those of the two functions above; both frames and times given.
[[nodiscard]] Result<FrameRange> chosen_range(const PartOptions& part, const FrameRate& rate,
                                              int frame_count);

}  // namespace retarget
