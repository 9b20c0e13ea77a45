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

/// The contents of a new robot's folder, and notes about them.
struct MadeRobot {
  std::string name;                  ///< Name of the robot.
  std::string model;                 ///< `model.xml`: MJCF without meshes.
  std::string profile;               ///< `robot.json`.
  std::string config;                ///< `ik.json`: from the canonical human.
  std::string decisions;             ///< `decisions.md`: the decisions and their certainty.
  std::vector<std::string> notes;    ///< Items that a user should check, one line each.
  std::vector<std::string> summary;  ///< Detected limbs, T-pose and scales, one line each.
};

/// Makes the contents of a robot's folder from a model: MJCF, or URDF as MuJoCo reads it. Does not
/// read meshes, so that package:// paths have no effect. Adds a free joint to a model without one,
/// also in place of slide joints at the root.
///
/// Errors (kConfig): models that load_robot rejects, closed chains, lengths and ranges in other
/// units, limbs without knee or elbow, a T-pose that the joints cannot reach, and robots that are
/// not humanoid (an arm, a quadruped, wheels).
/// @param model_path  file of the model.
/// @param name        name of the robot.
/// @param base  kFixed: an upper body with a fixed base; only arms are required.
[[nodiscard]] Result<MadeRobot> make_robot(const std::string& model_path, const std::string& name,
                                           RobotBase base = RobotBase::kAuto);

/// The files of a robot. An empty path means that the robot has no such file.
struct RobotSources {
  std::string name;     ///< Name in lists.
  std::string model;    ///< MJCF; empty in a list: the robot is known but not installed.
  std::string profile;  ///< `robot.json`
  std::string config;   ///< Configuration for LAFAN1's skeleton; without config_of_others, for all.
  std::string config_of_others;  ///< Configuration for all other sources.
  RobotBase base = RobotBase::kAuto;
  std::string warning = {};  ///< Another robot that the name may mean; empty: none.
  /// Set only for a robot that is not installed; robot.json states these for installed robots.
  std::string description = {};
  std::string licence = {};
  bool licence_stated = true;
};

/// Compares a robot with another model of it, such as its manufacturer's file, by joint and body
/// names: joints, their order in motions, axes, ranges, body positions in configurations spread
/// over the ranges, and masses.
/// @return one line per kind of difference; empty without differences.
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
/// Error findings: files with errors, with line and column; findings that depend on such a file are
/// omitted. A sole for only one of two feet, soles that are not at the foot of their side, variants
/// that lock a joint outside its range; unknown bodies and bones in a retargeting
/// configuration; rotation offsets with a T-pose error above 75 degrees; feet more than a quarter
/// of the leg length out of reach; no legs or arms; robots that make_robot() rejects. A model
/// without profile and configuration is read as in make_robot().
///
/// Notes: joints without a range; rotation offsets with an error above 8 degrees; targets slightly
/// out of reach; joints that no task moves; differences between left and right (weights, scales,
/// offsets, ranges); limit sets narrower, much wider than the model's ranges or apart from them;
/// joints without a speed limit; missing soles or T-pose; T-pose positions outside the ranges;
/// couplings without effect.
/// @return a kConfig error if the model cannot be loaded.
[[nodiscard]] Result<std::vector<RobotFinding>> check_robot(
    const RobotSources& robot, OptionSpelling spelling = option_as_field);

}  // namespace retarget
