#pragma once

#include <Eigen/Core>
#include <optional>

#include "human/calibrate.h"
#include "human/posed_body.h"
#include "retarget/options.h"

namespace retarget {

/// Axes of the whole body in a pose: rows are its forward, left and up in the file's axes, so that
/// it maps the file's directions to x forward, y left, z up.
using BodyFromFile = Eigen::Matrix3d;

/// Left is from the right to the left hip and upper arm, across `up`; forward is left x up.
/// Nothing when that is no direction.
[[nodiscard]] std::optional<BodyFromFile> body_axes(const Body& body, const JointPoses& pose,
                                                    const Eigen::Vector3d& up);

/// The same with a facing that is told; `forward` must not be along `up`.
[[nodiscard]] BodyFromFile told_axes(const Eigen::Vector3d& forward, const Eigen::Vector3d& up);

/// The axis nearest to a direction.
[[nodiscard]] SignedAxis nearest_axis(const Eigen::Vector3d& direction);

/// From the hips to the head (or the highest trunk bone there is), unit length.
[[nodiscard]] std::optional<Eigen::Vector3d> trunk_direction(const Body& body,
                                                             const JointPoses& pose);

/// Rotation from the file's axes to z up: the identity for +z, the quarter turn about x for +y.
/// Of determinant +1 for every axis.
[[nodiscard]] Eigen::Matrix3d z_up_from_file(const SignedAxis& up);

}  // namespace retarget
