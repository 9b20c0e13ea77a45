#pragma once

#include <optional>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/options.h"

namespace retarget {

/// Determines the up axis of a robot's motion and sets it in the calibration. Motions of robots
/// have Z up. A motion that stands on a floor perpendicular to another axis, or falls along one,
/// was written in other axes: it is rotated, or the calibration gets a warning, by the same evidence
/// as for humans (choose_up).
/// @param clip  of clip_of_robot_human
/// @param map   of bone_map_of_robot
/// @param told  the user's axis, which decides.
void settle_robot_up(const Clip& clip, const BoneMap& map, const std::optional<SignedAxis>& told,
                     Calibration& calibration);

}  // namespace retarget
