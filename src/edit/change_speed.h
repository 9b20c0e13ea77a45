#pragma once

#include "motion/resample.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The clip at its own rate, played `speed` times as fast: frame i is the source at the time
/// i * speed / rate. Times are exact and faster motion is low-passed first, both as in `resample`
/// (of which this is another use: the source taken as a clip of speed times its rate).
///
/// Usage errors: a speed below 0.01 or above 100.
[[nodiscard]] Result<Clip> change_speed(Clip clip, double speed,
                                        const ResampleOptions& options = {});

}  // namespace retarget
