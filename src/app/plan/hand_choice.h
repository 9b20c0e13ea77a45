#pragma once

#include "human/skeleton/source_hands.h"
#include "retarget/clip.h"
#include "retarget/plan.h"

namespace retarget {

/// The source's hands that the robot's hands follow. The whole clip decides, except its lead-in and a
/// lost end (count_lost_end_frames()), so that a pose held during an excerpt is followed.
/// @param clip  the plan's clip, at its own rate.
[[nodiscard]] SourceHands choose_hands(const Clip& clip, const Plan& plan);

/// Adds the note about the motion of the robot's fingers, or replaces it in its place.
void note_hands(const Clip& clip, Plan& plan);

}  // namespace retarget
