#pragma once

#include <optional>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"
#include "retarget/options.h"

namespace retarget {

/// Finds the up axis from free fall: in flight, the centre of mass has a constant acceleration
/// along gravity. Returns nothing if the clip has less than a quarter of a second of flight, or if
/// the directions differ.
///
/// Lengths are in legs, so the unit is not needed: gravity is 9 to 16 legs/s^2 for legs of 1.1 to
/// 0.6 m.
/// @param begin  first frame to use
[[nodiscard]] std::optional<SignedAxis> free_fall_axis(const Clip& clip, const Body& body,
                                                       int begin);

/// Length of thigh and shin from the OFFSETs, averaged over both sides, file units; 0 if unknown.
[[nodiscard]] double leg_length(const Body& body);

}  // namespace retarget
