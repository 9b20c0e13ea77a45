#pragma once

#include <array>
#include <optional>

#include "motion/two_bone_leg.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Returns true if `joint` is `above` or one of its descendants.
[[nodiscard]] bool is_at_or_below(const Skeleton& skeleton, int joint, int above);

/// Returns the legs of a body, left and right; nothing if joints are missing or do not form a
/// chain.
[[nodiscard]] std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                                const Calibration& calibration);

}  // namespace retarget
