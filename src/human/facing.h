#pragma once

#include <Eigen/Core>

#include "human/candidate.h"

namespace retarget {

/// Below minus this, left_is_left and the mean of leg_facing say that sides are swapped.
inline constexpr double kMinSwapEvidence = 0.1;

/// What a leg tells of where the front is: knees bend to the front, and toes point there.
/// @param thigh, shin  from joint to joint, any length unit.
/// @param foot   from the ankle to the tip of the foot; about zero: unknown.
/// @param front  a unit vector.
/// @return about 1: the front; about -1: the back; near 0: the leg does not tell.
[[nodiscard]] double leg_facing(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                                const Eigen::Vector3d& foot, const Eigen::Vector3d& front);

/// Whether the left side of a map is the left of the body: where toes point and knees bend is the
/// front, and left x up = front holds of no mirrored body.
/// @return about 1: left is left; about -1: left is right; near 0: the poses do not tell.
[[nodiscard]] double left_is_left(const BodySource& source, const BoneMap& map);

}  // namespace retarget
