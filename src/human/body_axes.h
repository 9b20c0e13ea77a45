#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "human/calibrate.h"
#include "human/posed_body.h"

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

/// The file's up axis by what the movement shows: the axis along which, over the poses, the head
/// stays above the hips and these above the feet, on average, and above which the lowest joint
/// wanders least. y, BVH's custom, is taken when it does nearly as well as the best, and when the
/// body lies: the lowest joint keeps much stiller along y than along the best.
struct UpGuess {
  SignedAxis axis;
  double certainty = 0.0;  ///< Mean cosine of the trunk and the legs to the axis.
};
[[nodiscard]] UpGuess guess_up(const Body& body, const std::vector<JointPoses>& poses);

/// How far the lowest joint wanders along an axis, from the tenth to the fiftieth percentile of the
/// poses so that jumps do not count, in legs, at most 1.
[[nodiscard]] double floor_wander(const Body& body, const std::vector<JointPoses>& poses,
                                  const SignedAxis& up);

/// Whether the body is on a floor at height 0 along an axis: half of the poses have their lowest
/// joint within a fifth of a leg's length of it, as nearly all recordings have along up.
[[nodiscard]] bool is_on_floor(const Body& body, const std::vector<JointPoses>& poses,
                               const SignedAxis& up);

/// Rotation from the file's axes to z up: the identity for +z, the quarter turn about x for +y.
/// Of determinant +1 for every axis.
[[nodiscard]] Eigen::Matrix3d z_up_from_file(const SignedAxis& up);

}  // namespace retarget
