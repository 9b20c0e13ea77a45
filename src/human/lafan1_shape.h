#pragma once

#include <string>
#include <vector>

#include "retarget/motion/skeleton.h"

namespace retarget {

/// Joints of LAFAN1's names whose offsets are not as LAFAN1's: limbs along x, left and right apart
/// along z.
[[nodiscard]] std::vector<std::string> joints_off_lafan1_axes(const Skeleton& skeleton);

/// Thigh and shin of LAFAN1's left leg, file units; 0 without.
[[nodiscard]] double lafan1_leg_length(const Skeleton& skeleton);

/// Whether that is a leg in centimetres: from a child's to a giant's.
[[nodiscard]] bool is_leg_in_centimetres(double length);

}  // namespace retarget
