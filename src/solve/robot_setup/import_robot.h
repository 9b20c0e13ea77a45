#pragma once

#include <map>
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

/// A robot imported from a third-party model: with a floating or fixed base, and all parts named.
struct ImportedRobot {
  std::shared_ptr<Robot> robot;
  std::vector<std::string> notes;  ///< Changes to the model, one line each.
  std::vector<TiedBodies> tied;    ///< Body pairs of equality constraints that were dropped.
  std::vector<std::pair<std::string, std::string>> excluded;  ///< As LoadedModel::excluded.
};

/// Imports a model. The resulting profile contains only the name and the joint couplings.
/// @param base  kFixed: the robot has a fixed base (Robot::fixed_base).
/// Errors (kConfig): those of load_model and check_robot_joints, and names that are not UTF-8.
[[nodiscard]] Result<ImportedRobot> import_robot(const std::string& path, const std::string& name,
                                                 RobotBase base = RobotBase::kAuto);

/// Checks the closed chains of a robot, which the tree leaves open. Rods and other parts next to
/// the limbs keep their pose, which `notes` reports.
/// Errors (kConfig): both ends of a constraint move with limbs or trunk.
[[nodiscard]] Result<void> check_closed_chains(const ImportedRobot& imported,
                                               const RobotAnatomy& limbs, const std::string& path,
                                               std::vector<std::string>& notes);

/// Returns the findings from a model's numbers alone: an implausible size (wrong unit), and ranges
/// that are missing, empty, or in the wrong unit.
[[nodiscard]] std::vector<RobotFinding> model_findings(const Robot& robot);

/// Returns the joint speed limits stated in a URDF (`<limit velocity="...">`), above 0; rad/s or
/// m/s. Empty for files that are not URDF.
[[nodiscard]] std::map<std::string, double> urdf_speeds(const std::string& path);

}  // namespace retarget
