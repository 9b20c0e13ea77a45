#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// Correspondence between the two sides of a body.
struct BodyMirror {
  std::vector<int> mates;  ///< Counterpart of every joint; midline joints are their own.
  /// Reflection of every joint (orthogonal, determinant -1) from directions in its axes to their
  /// mirror images in its counterpart's axes. With W the joint's world rotation and M the world's
  /// mirror, the counterpart in the mirrored body has the world rotation M W mate_axes^-1.
  std::vector<Eigen::Matrix3d> mate_axes;
};

/// Finds the counterparts and reflections of all joints. Joints that are bones are paired by the
/// calibration, joints between them by their position in the chain, and all others (fingers, ends)
/// below paired joints by the position and shape of their subtrees.
///
/// In most files the zero pose is symmetric; one reflection then applies to every joint and nothing
/// is guessed. Otherwise each joint has its own: the first of the following that agrees with the
/// child offsets of the joint and its counterpart. (1) That of the T-pose, G_mate^-1 M G (G the
/// world rotations in the T-pose, which may be guessed), if it is close to a map between coordinate
/// axes, as rigs usually are. (2) That of its parent, which comes first for midline joints and
/// joints that turn no bone. (3) That of the T-pose unchanged, with the smallest correction that is
/// needed.
///
/// @return a kInput error naming a joint without a counterpart.
[[nodiscard]] Result<BodyMirror> body_mirror(const Skeleton& skeleton,
                                             const Calibration& calibration);

}  // namespace retarget
