#pragma once

#include <cstddef>

#include "retarget/clip.h"

namespace retarget {

/// Interpolates the rotations of a joint in a gap, between the frames before and after it.
/// @pre a frame precedes the gap and one follows it
void bridge_rotations(Clip& clip, std::size_t joint, FrameRange gap);

/// Interpolates the translations of a slot (Skeleton::translation_slot) likewise.
void bridge_translations(Clip& clip, std::size_t slot, FrameRange gap);

/// Interpolates the rotations of all joints, and the translations that do not change in the gap:
/// others are not lost.
void bridge_body(Clip& clip, FrameRange gap);

}  // namespace retarget
