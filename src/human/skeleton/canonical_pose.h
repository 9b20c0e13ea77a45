#pragma once

#include <Eigen/Core>

#include "retarget/human.h"

namespace retarget {

/// Orientation of a bone (world from bone) in the canonical human's T-pose. World axes: x forward,
/// y left, z up. The columns are the bone's X, Y and Z axes:
///
///     Hips, Spine*, Neck, Head      up                      forward  left
///     UpLeg, Leg                    down                    forward  right
///     Foot                          forward, 25 deg down    up       right
///     Toe, FootMod                  forward                 up       right
///     left clavicle, arm, hand      left                    back     up
///     right clavicle, arm, hand     right                   back     down
///
/// These are the joint axes of LAFAN1's skeleton in a T-pose: X runs along the bone, as the
/// skeleton's OFFSETs do, and knees and elbows bend about -Z.
[[nodiscard]] Eigen::Matrix3d canonical_t_pose(Bone bone);

}  // namespace retarget
