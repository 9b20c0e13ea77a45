#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/limbs.h"
#include "retarget/error.h"
#include "retarget/rig.h"
#include "retarget/robot.h"
#include "robot/load_model.h"

namespace retarget {

/// A robot read from a model that was not made for this program: floating, or a base that stands fast,
/// and every part named.
struct ImportedRobot {
  std::shared_ptr<Robot> robot;
  std::vector<std::string> notes;                             ///< What was changed, one line each.
  std::vector<TiedBodies> tied;                               ///< Of equalities that were dropped.
  std::vector<std::pair<std::string, std::string>> excluded;  ///< As LoadedModel's.
};

/// Reads a model. Its profile has nothing but the name and couplings of joints.
/// @param base  kFixed: the robot's base stands fast (Robot::fixed_base).
/// kConfig errors: what load_model and check_robot_joints reject, names that are not UTF-8.
[[nodiscard]] Result<ImportedRobot> import_robot(const std::string& path, const std::string& name,
                                                 RobotBase base = RobotBase::kAuto);

/// Tells what a tree makes of a robot's closed chains: rods and other helpers beside the limbs stay
/// as they are, which `notes` says.
/// kConfig error: both ends of a tie move with limbs or trunk.
[[nodiscard]] Result<void> check_closed_chains(const ImportedRobot& imported,
                                               const RobotAnatomy& limbs, const std::string& path,
                                               std::vector<std::string>& notes);

/// What a model's numbers show to be wrong or odd, whatever its limbs are: its size (another unit),
/// ranges that are missing, closed, or in another unit.
[[nodiscard]] std::vector<RobotFinding> model_findings(const Robot& robot);

}  // namespace retarget
