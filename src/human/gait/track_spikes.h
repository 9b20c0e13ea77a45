#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Interpolates over spikes: a joint turns by more than 30 degrees in one frame, or moves by more
/// than 0.15 m, and returns within three frames, while it is much slower before and after. No body
/// reverses that fast. Does not change clips with fewer than 22 frames per second.
/// @return one sentence per joint: `Hips jumped away in 1 frame`.
std::vector<std::string> bridge_spikes(Clip& clip, FrameRange part, double metres_per_unit);

}  // namespace retarget
