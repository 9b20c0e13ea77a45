#pragma once

#include "retarget/clip.h"

namespace retarget {

/// Number of frames at the end of a clip in which all rotations are zero, after a jump that no human
/// can make: a step of more than 0.1 spreads (count_lead_in_frames) and more than five times the
/// step before.
[[nodiscard]] int count_lost_end_frames(const Clip& clip);

}  // namespace retarget
