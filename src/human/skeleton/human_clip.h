#pragma once

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/pose.h"

namespace retarget {

/// Calibration of LAFAN1's skeleton as in the published method: file units are centimetres, Y is
/// up, and the body height is 1.75 m, independent of the bones. The synthetic feet are at the
/// ankles and turn with the toes.
/// @param joints   joints of the bones; -1: the bone is absent
/// @param turning  joints whose rotations turn the bones
[[nodiscard]] Calibration lafan1_calibration(const BoneArray<int>& joints,
                                             const BoneArray<int>& turning);

}  // namespace retarget
