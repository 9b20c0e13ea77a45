#pragma once

#include <string>
#include <vector>

#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/robot_hands.h"
#include "robot/anatomy/shapes.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/self_test.h"
#include "solve/robot_setup/t_pose.h"

namespace retarget {

/// Results of the analysis of a robot's model.
struct RobotFindings {
  const Robot& robot;
  const RobotAnatomy& limbs;
  const TPose& t_pose;
  const RobotShapes& shapes;
  const std::vector<std::string>& overlaps;  ///< Pairs of bodies whose self-contact is allowed.
  const RetargetingConfig& config;
  const SelfTest& self_test;
  const RobotHands& hands;
  const std::map<std::string, double>& speeds;  ///< Joint speed limits of the model.
  std::string source;                           ///< File name of the model.
};

/// Items that a user should check, one line each.
[[nodiscard]] std::vector<std::string> notes_about(const RobotFindings& findings);

/// A summary of the findings, one line each.
[[nodiscard]] std::vector<std::string> summary_of(const RobotFindings& findings);

/// The text of decisions.md.
[[nodiscard]] std::string decisions_text(const RobotFindings& findings,
                                         const std::vector<std::string>& notes);

/// Formats an angle in degrees with one decimal.
[[nodiscard]] std::string degrees_text(double radians);

}  // namespace retarget
