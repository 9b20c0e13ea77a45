#pragma once

#include <optional>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "smpl/array_source.h"

namespace retarget {

/// The frame rate that a motion's file states, by whichever name; nothing where it states none.
/// Errors: two rates that differ, what is no rate.
/// @param source_fps  in place of the file's; positive and finite.
[[nodiscard]] Result<std::optional<FrameRate>> read_motion_rate(const ArraySource& file,
                                                                std::optional<double> source_fps);

/// The error of a file that states none, and of whose kind nothing is known.
[[nodiscard]] Failure no_motion_rate(const ArraySource& file);

}  // namespace retarget
