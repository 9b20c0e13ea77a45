#pragma once

#include <array>
#include <string>

#include "retarget/error.h"
#include "retarget/robot.h"
#include "robot/anatomy/limb_shape.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Makes both knees or elbows bend to mirrored sides. If only one side's range determines the
/// direction, the other side follows it. If the ranges conflict but leave some room, knees bend
/// backwards and elbows forwards or inwards, with a note.
/// @param limbs  left, right; LimbShape::flexion is set.
/// @param found  its facing direction must be known.
/// Errors (kConfig): knees or elbows that can only bend to opposite sides.
[[nodiscard]] Result<void> compare_flexion(const Robot& robot, const std::string& file, bool is_leg,
                                           std::array<LimbShape, 2>& limbs, RobotAnatomy& found);

}  // namespace retarget
