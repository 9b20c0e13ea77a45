#pragma once

#include <cstddef>

#include "human/gait/contact_plan.h"

namespace retarget {

/// Returns the height of the floor on which the feet of a plan stand, metres.
[[nodiscard]] double floor_height(const ContactPlan& contacts);

/// Returns the largest height of a support's joint above the floor when the body lies, kneels,
/// leans or sits on it, metres.
/// @param support  index into kSupportBones.
/// @param scale    scale of lengths, as ContactPlan::scale.
[[nodiscard]] double rest_height(std::size_t support, double scale);

}  // namespace retarget
