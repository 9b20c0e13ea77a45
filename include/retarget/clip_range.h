#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

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

/// The frames of a clip that the options select, by frames or by times; all frames by default.
/// Usage errors: those of the two functions above; both frames and times given.
[[nodiscard]] Result<FrameRange> chosen_range(const PartOptions& part, const FrameRate& rate,
                                              int frame_count);

/// A warning if the options select frames or times beyond the end of the clip, by more than one
/// frame; otherwise none. chosen_range cuts such a part at the end of the clip.
[[nodiscard]] std::vector<Warning> range_doubts(const PartOptions& part, const FrameRate& rate,
                                                int frame_count);

/// Number of frames at the beginning of a clip that are not part of its motion: one or several
/// static poses (a T-pose, all zeros), each followed by a jump that no human can make. 0 if the
/// motion begins with the first frame.
///
/// A jump is a step with a large second difference (mean over the joints): larger than 0.1 times
/// the spread of the body (the root mean square distance of its joints from their mean) and larger
/// than five times the 95th percentile of the second differences in the next two seconds. After a
/// frame in which all rotations are zero, a step of more than 0.1 spreads and more than five times
/// the next step is also a jump. A pose is held while it stays within 0.05 spreads of its first
/// frame. Frames belong to the motion if they move before the jump, are held for more than 20 s, or
/// are held for more than 0.25 s in a pose to which the motion returns within 2 s.
[[nodiscard]] int count_lead_in_frames(const Clip& clip);

}  // namespace retarget
