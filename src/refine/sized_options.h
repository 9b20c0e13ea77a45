#pragma once

#include "retarget/options.h"

namespace retarget {

/// Options for a robot of some size: weights per metre are those of a robot whose legs are as long
/// as the G1's, and of one half as large, whose limbs move half as far for the same angles, they
/// count twice. Contacts, floor and overlaps, whose amounts matter in metres, never count less.
/// @param leg  hip to knee to ankle, metres, above 0.
[[nodiscard]] FitOptions sized_options(FitOptions options, double leg);

}  // namespace retarget
