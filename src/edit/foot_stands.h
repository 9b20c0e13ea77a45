#pragma once

#include <array>
#include <vector>

#include "edit/plant_feet.h"
#include "human/human_clip.h"

namespace retarget {

/// A foot that stands: on its sole, on its heel or on its toes.
struct FootStand {
  int begin = 0, end = 0;           ///< Frames [begin, end).
  std::vector<FootStance> stances;  ///< One per frame.
};

/// When the feet of a human stand, left and right. To the contacts of whole feet
/// (find_contacts) come the frames in which the heel is up and the toes stand yet, or the toes
/// are up and the heel stands already, by the same thresholds; a foot with its toes level with the
/// ankle or above it lies.
/// @param same_stand  stands with a shorter break are one, seconds.
[[nodiscard]] std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human,
                                                                     double same_stand);

}  // namespace retarget
