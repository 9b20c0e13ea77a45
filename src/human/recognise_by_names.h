#pragma once

#include "human/candidate.h"

namespace retarget {

/// Finds bones by words in the joint names, as far as the tree agrees.
///
/// Each limb is found whole: of all ways to choose its joints so that they lie in line, the one
/// whose names fit best, so that `LeftLeg` is the thigh above `LeftShin` and the shin below
/// `LeftUpLeg`. Limbs that are not found stay unmapped. Two ways of equal merit that do not lie in
/// line are an error naming the joints; of joints in line the one nearer the body counts.
[[nodiscard]] Candidate recognise_by_names(const BodySource& source);

}  // namespace retarget
