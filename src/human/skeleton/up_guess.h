#pragma once

#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/options.h"

namespace retarget {

/// Guess of the up axis from the movement: on average over the poses, the head stays above the hips
/// and the hips above the feet, and the lowest joint varies least. y, the convention of BVH, wins if
/// it scores nearly as well as the best axis, or if the body lies: the lowest joint then varies much
/// less along y than along the best axis.
struct UpGuess {
  SignedAxis axis;
  double certainty = 0.0;  ///< Mean cosine between the axis and the trunk and legs.
};

[[nodiscard]] UpGuess guess_up(const Body& body, const std::vector<JointPoses>& poses);

}  // namespace retarget
