#pragma once

#include <Eigen/Core>
#include <optional>

#include "human/skeleton/calibrate.h"
#include "human/skeleton/posed_body.h"
#include "retarget/options.h"

namespace retarget {

/// Body axes in a pose: the rows are forward, left and up in file axes, so the matrix maps file
/// directions to x forward, y left, z up.
using BodyFromFile = Eigen::Matrix3d;

/// Left is the direction from the right to the left hip and upper arm, orthogonal to `up`; forward
/// is left x up. Returns nothing if this direction is degenerate.
[[nodiscard]] std::optional<BodyFromFile> body_axes(const Body& body, const JointPoses& pose,
                                                    const Eigen::Vector3d& up);

/// As body_axes, with a given facing. `forward` must not be parallel to `up`.
[[nodiscard]] BodyFromFile told_axes(const Eigen::Vector3d& forward, const Eigen::Vector3d& up);

/// Returns the axis closest to a direction.
[[nodiscard]] SignedAxis nearest_axis(const Eigen::Vector3d& direction);

/// Direction from the hips to the head, or to the highest mapped trunk bone; unit length.
[[nodiscard]] std::optional<Eigen::Vector3d> trunk_direction(const Body& body,
                                                             const JointPoses& pose);

/// Rotation from file axes to z up: the identity for +z, a quarter turn about x for +y. The
/// determinant is +1 for every axis.
[[nodiscard]] Eigen::Matrix3d z_up_from_file(const SignedAxis& up);

}  // namespace retarget
