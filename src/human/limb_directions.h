#pragma once

#include <optional>

#include "human/bone_map.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// Files with positions for every joint need not agree with their own rotations: some hold
/// positions alone and rotations that mean nothing. How far rotations are from carrying the joints
/// below them, limbs tell: of the angles, root mean square over the frames, by which the far ends of
/// thighs, shins, upper arms and forearms wander as their own joints see them, the second largest, for
/// one limb may have a joint that slides. Where that is above 3 degrees (knees and elbows that slide
/// and limbs that stretch stay far below) positions win:
///
/// The joints of mapped bones get rotations with axes as the canonical bones have (canonical_t_pose),
/// X along the bone. Hips, trunk and clavicles take the rest from the lines across hips and shoulders,
/// limbs from the plane in which they bend; a limb that is straight keeps the plane of the frames
/// around, seen from the one in which it is bent most. How forearms, hands and head turn about
/// themselves is not known; they follow their neighbours. The skeleton's OFFSETs become the mean
/// positions in these axes, and the map's facts say that axes are to be learned.
/// @return what to tell the user; nothing where rotations and positions agree, or where positions are
///     not known of all bones.
[[nodiscard]] std::optional<Warning> let_directions_win(Clip& clip, BoneMap& map);

/// How the plane of a limb that is straight goes on from frame to frame.
enum class StraightLimbs : unsigned char {
  kStay,  ///< By the least turn in the world: a body that turns on straight legs leaves them.
  kTurnWithTrunk,  ///< By the least turn as hips or torso see it.
};

/// The same of any clip whose mapped joints, and those between, have position channels, whatever their
/// rotations are. The map has Hips.
void make_rotations_from_directions(Clip& clip, BoneMap& map, StraightLimbs straight);

}  // namespace retarget
