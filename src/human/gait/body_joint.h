#pragma once

#include <Eigen/Core>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// The joint that moves the whole body: the topmost one from the hips upwards that has a position;
/// -1: none.
[[nodiscard]] int body_joint(const Skeleton& skeleton, const Calibration& calibration);

/// Translates the whole body.
/// @param joint  body_joint()
/// @param shift  world, metres
void move_body(Clip& clip, int frame, const Calibration& calibration, int joint,
               const Eigen::Vector3d& shift);

}  // namespace retarget
