#pragma once

#include <array>
#include <vector>

#include "edit/plant_feet.h"
#include "human/skeleton/human_clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// A stance of a foot: on its sole, its heel or its toes.
struct FootStand {
  int begin = 0, end = 0;           ///< Frames [begin, end).
  std::vector<FootStance> stances;  ///< One per frame.
};

/// Returns the stances of the left and right foot of a human. Extends the contacts of whole feet
/// (find_contacts) by frames with the heel up and the toes still down, or the toes up and the heel
/// already down, using the same thresholds. A foot whose toes are level with the ankle or above it
/// is lying, not standing.
/// @param same_stand  stances separated by less than this are merged, seconds.
[[nodiscard]] std::array<std::vector<FootStand>, 2> find_foot_stands(const HumanClip& human,
                                                                     double same_stand);

/// Returns the planted foot of a stance, at its current position.
/// @param frame   frame from which the toe position in the foot is taken.
/// @param ankles  poses of the ankle joint (ankle_poses) in every frame.
[[nodiscard]] PlantedFoot plant_of(const FootStand& stand, int foot, int frame,
                                   const std::vector<Pose>& ankles, const HumanClip& human);

}  // namespace retarget
