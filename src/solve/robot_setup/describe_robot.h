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

/// Everything known about a robot that is being added.
struct RobotFindings {
  const Robot& robot;
  const RobotAnatomy& limbs;
  const TPose& t_pose;
  const RobotShapes& shapes;
  const std::vector<std::string>& overlaps;  ///< Pairs of bodies whose contact is ignored.
  const RetargetingConfig& config;
  const SelfTest& self_test;
  const RobotHands& hands;
  std::size_t speed_count = 0;  ///< Number of joints whose speed limit the model states.
  std::string source;           ///< The model's file name.
};

/// Returns the notes for the user to check, one line each.
[[nodiscard]] std::vector<std::string> notes_about(const RobotFindings& findings);

/// Returns the summary of the findings, one line each.
[[nodiscard]] std::vector<std::string> summary_of(const RobotFindings& findings);

/// Returns the text of decisions.md.
[[nodiscard]] std::string decisions_text(const RobotFindings& findings,
                                         const std::vector<std::string>& notes);

/// Formats an angle in degrees with one decimal.
[[nodiscard]] std::string degrees_text(double radians);

}  // namespace retarget
