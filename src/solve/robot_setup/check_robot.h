#pragma once

#include <string>
#include <vector>

#include "retarget/make_robot.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Files of a robot with errors. Findings that depend on their contents are left out.
struct UnreadFiles {
  bool profile = false;
  bool config = false;
};

/// The findings of check_robot() (make_robot.h) about a robot with one retargeting configuration.
/// @param config  null: the robot has no configuration, or it is among the unread files.
[[nodiscard]] std::vector<RobotFinding> check_robot(const Robot& robot,
                                                    const RetargetingConfig* config,
                                                    const UnreadFiles& unread = {});

/// The findings about a robot's shapes and soles: body pairs that overlap in the model itself, with
/// and without an allowed self-contact, and the source of soles that the profile lacks or
/// estimates. Empty for a model that is not a humanoid.
/// @param model_path  file of the robot's model; its meshes may be missing.
[[nodiscard]] std::vector<RobotFinding> check_shapes(const Robot& robot,
                                                     const std::string& model_path);

}  // namespace retarget
