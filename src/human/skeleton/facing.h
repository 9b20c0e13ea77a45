#pragma once

#include <Eigen/Core>

#include "human/skeleton/candidate.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// The sides are swapped if left_is_left, or the mean of leg_facing, is below minus this value.
inline constexpr double kMinSwapEvidence = 0.1;

/// Evidence of a leg for the direction `front`: knees bend forwards, and toes point forwards.
/// @param thigh, shin  vectors between the joints, any length unit
/// @param foot   vector from the ankle to the tip of the foot; nearly zero: unknown
/// @param front  a unit vector
/// @return about 1: the front; about -1: the back; near 0: no evidence
[[nodiscard]] double leg_facing(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                                const Eigen::Vector3d& foot, const Eigen::Vector3d& front);

/// Evidence that the left side of a map is the left of the body. The front follows from toes and
/// knees, and left x up = front fails for a mirrored body.
/// @return about 1: correct; about -1: swapped; near 0: no evidence
[[nodiscard]] double left_is_left(const BodySource& source, const BoneMap& map);

}  // namespace retarget
