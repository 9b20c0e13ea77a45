#pragma once

#include <optional>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Corrects the twist of thighs, shins, upper arms and forearms whose rotations contradict the
/// bends of their limbs.
///
/// Knees and elbows are hinges: the normal of the bend is constant in the bones on both sides of
/// the joint. Rotations that were transferred from another skeleton may violate this. If the normal
/// deviates by more than 20 degrees (root mean square, weighted by the sine of the bend) in both
/// bones of a limb, the function twists the bones such that the hinge axis is the calibrated one
/// (make_rotations_from_directions; arms with the habits of learned_axes). Joint positions, hands
/// and feet do not change.
/// @param calibration  calibration of the clip; remains valid
/// @return a message for the user; nothing if no limb was changed
[[nodiscard]] std::optional<Warning> let_bends_win(Clip& clip, const BoneMap& map,
                                                   const Calibration& calibration);

}  // namespace retarget
