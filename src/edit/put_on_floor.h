#pragma once

#include <string>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// Height of the floor that a human stands on, metres: the median, over the frames in which a foot
/// is planted, of the lowest of that foot's joints and end sites. In a clip that is shorter than a
/// contact a foot is planted that stands still in all of it: in a single frame the lower one.
/// @param file  for messages.
/// @return a kInput error when no foot ever stands.
[[nodiscard]] Result<double> floor_height(const Clip& clip, const HumanMapping& mapping,
                                          const std::string& file);

/// The clip raised or lowered so that the floor is at height 0, which `floor` (metres) is now.
/// Input errors: a body that no joint moves as a whole.
[[nodiscard]] Result<Clip> put_on_floor(Clip clip, const HumanMapping& mapping, double floor,
                                        const std::string& file);

}  // namespace retarget
