#pragma once

#include "human/human_clip.h"

namespace retarget {

/// Whether b begins one frame after a's end, as the parts of a clip do that was cut in two and not
/// moved: of all spacings between the two, in steps of a quarter of a frame, one frame (half a frame
/// more or less) is that which makes the last four frames of a and the first four of b the
/// smoothest, by polynomials of fourth degree through the bones' positions. Clips of fewer frames,
/// and such as stand still, do not say.
[[nodiscard]] bool goes_on(const HumanClip& a, const HumanClip& b);

}  // namespace retarget
