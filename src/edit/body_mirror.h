#pragma once

#include <Eigen/Core>
#include <vector>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// How the two sides of a body mirror each other.
struct BodyMirror {
  std::vector<int> mates;  ///< Of every joint, its counterpart; joints of the middle are their own.
  /// Of every joint, the reflection (orthogonal, determinant -1) that takes directions in its axes
  /// to the mirror images in its counterpart's. With W the joint's world rotation and M the world's
  /// mirror, the counterpart of the mirrored body has the world rotation M W mate_axes^-1.
  std::vector<Eigen::Matrix3d> mate_axes;
};

/// Joints that are bones are paired by the calibration, those between them by their place along the way,
/// all others (fingers, ends) below paired joints by the place and shape of what hangs there.
///
/// Most files have a zero pose that is its own mirror image; there one reflection is every joint's,
/// and no guess is in it. In others each joint has its own, the first of these that agrees with what
/// leaves the joint and its counterpart: that of the T-pose, G_mate^-1 M G (G the world rotations in
/// the T-pose, which may be guessed), as far as it takes axes to axes, for rigs are made so; that of
/// its parent (for joints of the middle and such as turn no bone before all others); that of the
/// T-pose as it is, turned as little as it takes.
///
/// @return a kInput error naming a joint without a counterpart.
[[nodiscard]] Result<BodyMirror> body_mirror(const Skeleton& skeleton,
                                             const Calibration& calibration);

}  // namespace retarget
