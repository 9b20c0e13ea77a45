#pragma once

#include <vector>

#include "human/posed_body.h"
#include "human/rest_pose.h"

namespace retarget {

/// The sides on which the toes turn against the foot farther than toes do: by
/// more than 90 degrees from where they are in the T-pose, in more than one frame of a hundred. A
/// known fault of mocap data (CMU's, for one) turns them by 180 degrees; a robot's foot that
/// follows drags the whole body along.
/// @param axes  of foot and toes in their joints.
[[nodiscard]] std::vector<Side> sides_with_flipped_toes(const Body& body,
                                                        const std::vector<JointPoses>& poses,
                                                        const JointFromBone& axes);

}  // namespace retarget
