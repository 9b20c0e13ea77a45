#pragma once

#include <string>
#include <vector>

#include "retarget/rig.h"
#include "retarget/robot.h"

namespace retarget {

/// What is worth knowing of a robot's shapes and soles: pairs of bodies that overlap by the model itself,
/// counted as self-collision or not, and where soles come from that the profile has not, or estimates.
/// Nothing of a model that is no humanoid.
/// @param model_path  the robot's; its meshes may be missing.
[[nodiscard]] std::vector<RobotFinding> check_shapes(const Robot& robot,
                                                     const std::string& model_path);

}  // namespace retarget
