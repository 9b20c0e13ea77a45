#pragma once

#include "formats/smpl/joint_motion.h"
#include "human/skeleton/joint_tree.h"
#include "retarget/human.h"

namespace retarget {

/// Agreement of knees and toes with the front that follows from the left and right joints of a limb:
/// about 1 forwards, -1 backwards.
/// @pre the tree has the joints of both legs and both shoulders
[[nodiscard]] double facing_by(const JointTree& tree, LimbBone part);

/// Whether left joints are on the right of the body during the motion: knees bend and toes point
/// backwards if the joints' names give the front. Hips and shoulders must agree. False for a body
/// that lacks joints of the legs or a shoulder.
[[nodiscard]] bool sides_are_exchanged(const JointTree& tree);

/// The motion with the positions of all joints exchanged whose names differ only in the side.
/// @pre it has names and no rotations
[[nodiscard]] JointMotion with_exchanged_sides(JointMotion motion);

}  // namespace retarget
