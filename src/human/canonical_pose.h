#pragma once

#include <Eigen/Core>

#include "retarget/human.h"

namespace retarget {

/// World from bone in the canonical human's T-pose: world x forward, y left, z up; the columns
/// tell where the bone's X, Y and Z axes point.
///
///     Hips, Spine*, Neck, Head      up                      forward  left
///     UpLeg, Leg                    down                    forward  right
///     Foot                          forward, 25 deg down    up       right
///     Toe, FootMod                  forward                 up       right
///     left clavicle, arm, hand      left                    back     up
///     right clavicle, arm, hand     right                   back     down
///
/// These are the axes of LAFAN1's joints when a person of that skeleton stands in a T-pose: X runs
/// along the bone (as the skeleton's OFFSETs say) and knees and elbows bend about -Z.
[[nodiscard]] Eigen::Matrix3d canonical_t_pose(Bone bone);

}  // namespace retarget
