#pragma once

#include <array>
#include <vector>

#include "edit/plant_feet.h"
#include "human/human_clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

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

/// A foot in a stand, where it is.
/// @param ankles  poses of the ankle joint (ankle_poses) in every frame,
/// @param frame   and in which of them the place of the toes in the foot is taken.
[[nodiscard]] PlantedFoot plant_of(const FootStand& stand, int foot, int frame,
                                   const std::vector<Pose>& ankles, const HumanClip& human);

}  // namespace retarget
