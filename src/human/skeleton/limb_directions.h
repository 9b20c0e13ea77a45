#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Replaces a clip's rotations by ones made from joint positions, if the two disagree.
///
/// Files with positions for every joint need not agree with their own rotations: some hold only
/// positions and meaningless rotations. The test measures how far the far ends of thighs, shins,
/// upper arms and forearms wander in their own joints' frames, as root-mean-square angles over the
/// frames. It takes the second largest angle, since one limb may have a sliding joint. Above 3
/// degrees positions win; knees and elbows that slide and limbs that stretch stay far below.
///
/// The joints of mapped bones then get rotations with the axes of the canonical bones
/// (canonical_t_pose), X along the bone. Hips, trunk and clavicles take the remaining rotation from
/// the lines across hips and shoulders, limbs from the plane in which they bend. A straight limb
/// keeps the plane of the surrounding frames, propagated from the frame in which it bends most. The
/// twist of forearms, hands and head is unknown; they follow their neighbours. The skeleton's
/// OFFSETs become the mean positions in these axes, and the map's facts request that axes be
/// learned.
/// @return a message for the user; nothing if rotations and positions agree, or if positions are
///   not known for all bones.
[[nodiscard]] std::optional<Warning> let_directions_win(Clip& clip, BoneMap& map);

/// Propagates the bending plane of a straight limb from frame to frame.
enum class StraightLimbs : unsigned char {
  kStay,           ///< Minimal rotation in the world: legs stay when the body turns on them.
  kTurnWithTrunk,  ///< Minimal rotation relative to hips or torso.
};

/// World rotations of the canonical bones, by bone and frame, that let_directions_win makes; empty
/// for bones without a joint.
[[nodiscard]] BoneArray<std::vector<Eigen::Matrix3d>> rotations_from_directions(
    const Clip& clip, const Body& body, StraightLimbs straight);

/// Does the same for any clip whose mapped joints, and those between them, have position channels,
/// regardless of its rotations.
/// @pre the map has Hips
void make_rotations_from_directions(Clip& clip, BoneMap& map, StraightLimbs straight);

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
