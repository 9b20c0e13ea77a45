#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// The joint of a canonical bone, if there is one.
using JointOfBone = std::function<std::optional<int>(Bone bone)>;

/// Bones whose joints' offsets are not as LAFAN1's: limbs along x, left and right apart along z.
[[nodiscard]] std::vector<std::string> bones_off_lafan1_axes(const Skeleton& skeleton,
                                                             const JointOfBone& joint_of);

/// Thigh and shin of the left leg by its joints' offsets, file units; 0 without.
[[nodiscard]] double lafan1_leg_length(const Skeleton& skeleton, const JointOfBone& joint_of);

/// Whether that is a leg in centimetres: from a child's to a giant's.
[[nodiscard]] bool is_leg_in_centimetres(double length);

}  // namespace retarget
