#pragma once

#include <string>

#include "formats/smpl/joint_motion.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// Makes a clip from joint positions, in their unit and axes.
///
/// Without joint names, the one known joint order (joint_orders) that fits the positions applies.
/// Without rotations, make_rotations_from_directions computes them. They are identity in the
/// T-pose, whose OFFSETs have the median lengths. Trunk and head follow the upright body, limbs
/// their directions, hands their knuckles if these are known. Joints keep their recorded positions:
/// a joint that is constant in its parent's frame, within 1e-5 of the longest OFFSET, is fixed;
/// others have translations. The clip's origin lists the unknown rotations and has warnings about
/// findings and assumptions.
///
/// @param name  name of the clip
/// @return kInput errors: an unknown or ambiguous joint order, no body, duplicate names
[[nodiscard]] Result<Clip> clip_of_joints(const JointMotion& motion, const std::string& name);

}  // namespace retarget
