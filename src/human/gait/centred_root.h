#pragma once

#include <optional>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Restores the height of a body whose root rests at one place, as in joint positions relative to
/// the hips: its lowest part stays on the floor. Recorded hips move when the legs do, so that only the
/// hips' joint, or the middle of the hip joints, of a file without a root path is then still. Jumps
/// and the travel over the ground remain unknown. Does not change other clips.
/// @return largest change of the height, metres; empty if it is less than a centimetre
std::optional<double> restore_centred_height(Clip& clip, FrameRange part,
                                             const Calibration& calibration);

}  // namespace retarget
