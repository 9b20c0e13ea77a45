#pragma once

#include <array>
#include <string>

#include "retarget/error.h"
#include "retarget/robot.h"
#include "robot/anatomy/limb_shape.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

// Agreement of the two limbs of a pair.

/// Checks that both limbs end at corresponding joints: joints that do not mirror each other exactly
/// can end them at different ones (kConfig).
[[nodiscard]] Result<void> check_joint_counts(const Robot& robot, const std::string& file,
                                              const std::array<LimbShape, 2>& limbs);

/// Number of joints and bodies whose names mark the first limb as the left one, minus the number of
/// those that mark the second.
[[nodiscard]] int side_by_names(const Robot& robot, const std::array<LimbShape, 2>& limbs);

/// Makes both knees or elbows bend to mirrored sides. If only one side's range determines the
/// direction, the other side follows it. If the ranges conflict but leave some room, knees bend
/// backwards and elbows forwards or inwards, with a note.
/// @param limbs  left, right; LimbShape::flexion is set.
/// @param found  its facing direction must be known.
/// Errors (kConfig): knees or elbows that can only bend to opposite sides.
[[nodiscard]] Result<void> compare_flexion(const Robot& robot, const std::string& file, bool is_leg,
                                           std::array<LimbShape, 2>& limbs, RobotAnatomy& found);

}  // namespace retarget
