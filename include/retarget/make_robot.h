#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"

// Robots from models: the analysis. Link retarget::rig.
namespace RETARGET_API retarget {

/// The contents of a robot's folder before it is written, and notes about them.
struct MadeRobot {
  std::string name;
  std::string model;                 ///< `model.xml`: MJCF without meshes.
  std::string profile;               ///< `robot.json`.
  std::string config;                ///< `ik.json`: from the canonical human.
  std::string decisions;             ///< `decisions.md`: the decisions and their certainty.
  std::vector<std::string> notes;    ///< Items that a user should check, one line each.
  std::vector<std::string> summary;  ///< Detected limbs, T-pose and scales, one line each.
};

/// Makes a robot's folder from a model: MJCF, or URDF as MuJoCo reads it. Meshes are not needed, so
/// package:// paths do not matter. A model without a free joint gets one; it also replaces slide
/// joints at the root.
///
/// kConfig errors, one sentence each: models that load_robot rejects, closed chains, lengths and
/// ranges in other units, limbs without knee or elbow, a T-pose that the joints cannot reach, and
/// robots that are not humanoid (an arm, a quadruped, wheels).
/// @param base  kFixed: an upper body with a fixed base; only arms are required.
[[nodiscard]] Result<MadeRobot> make_robot(const std::string& model_path, const std::string& name,
                                           RobotBase base = RobotBase::kAuto);

/// The files of a robot. An empty path means that the robot has no such file.
struct RobotSources {
  std::string name;     ///< For lists.
  std::string model;    ///< MJCF; empty in a list: the robot is known but not installed.
  std::string profile;  ///< `robot.json`
  std::string config;   ///< For LAFAN1's skeleton; for all sources without config_of_others.
  std::string config_of_others;  ///< For all other sources.
  RobotBase base = RobotBase::kAuto;
  /// Set only for a robot that is not installed; robot.json states these for installed robots.
  std::string description = {};
  std::string licence = {};
  bool licence_stated = true;
};

/// Compares a robot with another model of it, such as its maker's file, by joint and body names:
/// joints, their order in motions, axes, ranges, body positions in configurations spread over the
/// ranges, and masses. One line per kind of difference; empty if there is none.
/// Errors: those of load_robot_files and make_robot's for a model that cannot be read.
[[nodiscard]] Result<std::vector<std::string>> compare_robot(const RobotSources& robot,
                                                             const std::string& model_path);

/// An error in a robot's files, or a note about them.
struct RobotFinding {
  bool fault = false;  ///< Error: motions are wrong or impossible. Otherwise a note.
  std::string text;
};

/// Checks a robot, its profile and its configurations. Lists errors first, then notes.
///
/// Errors: files that cannot be read; bodies and bones of a retargeting configuration that do not
/// exist; offsets that leave a limb more than 75 degrees off the T-pose; feet more than a quarter
/// of a leg out of reach; no legs or arms to map to; robots that make_robot rejects. A model
/// without profile and configuration is read as in make_robot.
///
/// Notes: joints without a range, offsets more than 8 degrees off, targets slightly out of reach,
/// joints that no task moves, differences between left and right (weights, scales, offsets,
/// ranges), limit sets tighter than the model's ranges, joints without a speed limit, missing soles
/// or T-pose.
/// @return a kConfig error if the model cannot be loaded.
[[nodiscard]] Result<std::vector<RobotFinding>> check_robot(
    const RobotSources& robot, OptionSpelling spelling = option_as_field);

}  // namespace retarget
