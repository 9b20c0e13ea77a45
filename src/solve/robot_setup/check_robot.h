#pragma once

#include <string>
#include <vector>

#include "retarget/make_robot.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Runs check_robot with one configuration.
/// @param config  the robot's configuration; null if it has none.
[[nodiscard]] std::vector<RobotFinding> check_robot(const Robot& robot,
                                                    const RetargetingConfig* config);

/// Returns the findings about a robot's shapes and soles: body pairs that overlap in the model
/// itself, whether or not they count as self-collision, and the source of soles that the profile
/// lacks or estimates. Empty for a model that is not a humanoid.
/// @param model_path  the robot's model; its meshes may be missing.
[[nodiscard]] std::vector<RobotFinding> check_shapes(const Robot& robot,
                                                     const std::string& model_path);

}  // namespace retarget
