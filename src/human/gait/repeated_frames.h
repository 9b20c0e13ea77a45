#pragma once

#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Interpolates over frames that repeat their predecessor, in clips that were written at a higher
/// rate than they were captured: frames of one capture are equal, and the body catches up in the
/// step to the next capture. At least a twelfth of the moving frames repeat their predecessor.
/// Otherwise does not change the clip.
/// @return number of interpolated frames.
int interpolate_held_frames(Clip& clip, FrameRange part);

/// Interpolates over lost frames: at least three in a row in which all joints have equal rotations
/// that are not on the body's way. The body jumps into this pose, such as the zero pose, and back:
/// in either step its joints turn by more than a radian together and by more than three times their
/// median step in the five frames to either side, and both steps together are more than 1.5 times
/// as long as the way from the frame before to the frame after. Keeps runs that follow a freeze,
/// because the body then catches up, those that last longer than a second, those within
/// five frames of the ends, such as calibration poses, and clips with more than a third of such
/// frames.
/// @return number of interpolated frames.
int bridge_lost_frames(Clip& clip, FrameRange part);

/// Interpolates over frozen frames: at least three equal ones in a row within a movement, followed
/// by a jump to where the body would have moved: its joints turn by more than twice their median
/// step in the five frames to either side, and by more than 0.4 of it per equal frame. The first
/// frame is on the body's way: the body does not jump into it and back. Freezes that last longer
/// than a second stay, and so do clips with more than a third of such frames, because they were
/// upsampled from fewer frames.
/// @return number of interpolated frames.
int bridge_frozen_frames(Clip& clip, FrameRange part);

/// Frozen frames that bridge_frozen_frames keeps although they are those of a dropout of a tracking
/// system: the body jumps afterwards (its joints turn, or its root moves, by more than three times
/// the median step around the freeze), or it stops at once and turns back at once.
[[nodiscard]] std::vector<FrameRange> kept_freezes(const Clip& clip, FrameRange part,
                                                   double metres_per_unit);

}  // namespace retarget
