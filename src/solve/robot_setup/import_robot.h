#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/make_robot.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"
#include "robot/model/load_model.h"

namespace retarget {

/// A robot imported from a third-party model. It has a floating or fixed base, and all parts have
/// names.
struct ImportedRobot {
  std::shared_ptr<Robot> robot;
  std::vector<std::string> notes;  ///< Changes to the model, one line each.
  std::vector<TiedBodies> tied;    ///< Body pairs of equality constraints that were dropped.
  std::vector<std::pair<std::string, std::string>> excluded;  ///< See LoadedModel::excluded.
};

/// Imports a model. The profile of the result contains only the name and the joint couplings.
/// @param path  file of the model: MJCF or URDF.
/// @param name  name of the robot.
/// @param base  kFixed: the robot has a fixed base (Robot::fixed_base).
/// Errors (kConfig): those of load_model and check_robot_joints, and names that are not UTF-8.
[[nodiscard]] Result<ImportedRobot> import_robot(const std::string& path, const std::string& name,
                                                 RobotBase base = RobotBase::kAuto);

/// Checks the closed chains of a robot, which its kinematic tree cannot represent. Rods and similar
/// parts next to the limbs keep their pose, which the function adds to `notes`.
/// Errors (kConfig): both ends of a constraint move with limbs or trunk.
[[nodiscard]] Result<void> check_closed_chains(const ImportedRobot& imported,
                                               const RobotAnatomy& limbs, const std::string& path,
                                               std::vector<std::string>& notes);

/// The findings about a model's lengths and ranges: an implausible size (wrong unit), and ranges
/// that are missing, empty, or in the wrong unit.
[[nodiscard]] std::vector<RobotFinding> model_findings(const Robot& robot);

}  // namespace retarget
