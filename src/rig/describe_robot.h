#pragma once

#include <string>
#include <vector>

#include "anatomy/limbs.h"
#include "anatomy/shapes.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "rig/derive_config.h"
#include "rig/t_pose.h"

namespace retarget {

/// All that was found out about a robot that is being added.
struct RobotFindings {
  const Robot& robot;
  const RobotAnatomy& limbs;
  const TPose& t_pose;
  const RobotShapes& shapes;
  const RetargetingConfig& config;
  std::size_t speed_count = 0;  ///< Joints whose speed limit the model states.
  std::string source;           ///< The model's file name.
};

/// What a user should look at, one line each.
[[nodiscard]] std::vector<std::string> notes_about(const RobotFindings& findings);

/// What was found, one line each.
[[nodiscard]] std::vector<std::string> summary_of(const RobotFindings& findings);

/// The text of decisions.md.
[[nodiscard]] std::string decisions_text(const RobotFindings& findings,
                                         const std::vector<std::string>& notes);

/// An angle in whole and tenth degrees.
[[nodiscard]] std::string degrees_text(double radians);

}  // namespace retarget
