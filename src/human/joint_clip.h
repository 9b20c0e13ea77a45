#pragma once

#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "smpl/joint_motion.h"

namespace retarget {

/// The clip of a body of which the places of joints are known, in their unit and axes.
///
/// Names, where there are none, are those of the one known order (joint_orders) that the places fit.
/// Where there are no rotations they are computed (make_rotations_from_directions), and turned so that
/// all are identity in the T-pose, whose OFFSETs have the median lengths: trunk and head as the body
/// holds them when it stands upright, limbs by their directions, hands by their knuckles where these
/// are known. Joints stay where the file has them: those that keep their place in their parent's frame
/// to 1e-5 of the longest OFFSET have it fixed, others have translations. The origin says which
/// rotations are unknown; its warnings what was found and assumed.
///
/// Errors (kInput): an order that is not known, or several that fit; no body; names given twice.
/// @param name  of the clip.
[[nodiscard]] Result<Clip> clip_of_joints(const JointMotion& motion, const std::string& name);

}  // namespace retarget
