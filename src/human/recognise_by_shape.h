#pragma once

#include "human/candidate.h"

namespace retarget {

/// Finds the body by the shape of the tree alone, whatever the joints are called.
///
/// Two joints are sought that each carry a pair of equal chains, the hips and the torso; the pairs
/// are legs and arms. What hangs on one side only (props, weapons) is in no pair. Which pair is
/// which is told by the head beside the arms, proportions and fingers; left from right by
/// left_is_left. Two answers of equal merit, or sides that the poses do not tell, are errors.
[[nodiscard]] Candidate recognise_by_shape(const BodySource& source);

}  // namespace retarget
