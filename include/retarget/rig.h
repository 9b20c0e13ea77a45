#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"

// Link retarget::rig.
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

/// Checks names and paths before a robot is made from a model and saved `into` a folder. kUsage
/// errors: the name is not a valid folder name, the model is inside the robot's folder.
[[nodiscard]] Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                                           const std::filesystem::path& into);

/// Writes the robot's folder into the folder `into`, completely or not at all. If the name already
/// exists, `force` replaces it atomically, but only if it is a folder whose robot.json make_robot
/// wrote for a robot of this name. kUsage errors: the name exists and cannot be replaced, it is not
/// a valid folder name, `into` does not exist.
/// @return the written folder.
[[nodiscard]] Result<std::filesystem::path> save_robot(const MadeRobot& robot,
                                                       const std::filesystem::path& into,
                                                       bool force);

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

/// Finds a robot by name or folder (find_robot), with its retargeting configurations.
/// Errors: those of find_robot.
[[nodiscard]] Result<RobotSources> find_robot_sources(const std::string& name_or_folder,
                                                      const std::string& data_folder);

/// The robot of a model file, with the `robot.json` and the retargeting configurations in the
/// model's folder and the data folder.
[[nodiscard]] RobotSources sources_of_model(const std::filesystem::path& model,
                                            const std::string& data_folder);

/// All robots, sorted by name: the installed ones, and without a model the known ones that are not
/// installed. Errors (kConfig): an invalid list of known robots.
[[nodiscard]] Result<std::vector<RobotSources>> list_robot_sources(const std::string& data_folder);

/// Form of a description: human-readable, or JSON with more digits.
enum class TextForm : unsigned char { kPlain, kJson };

/// Describes a robot: heights, joints with limits, configuration. Both forms are safe to print to a
/// terminal. kConfig errors: those of load_robot.
[[nodiscard]] Result<std::string> describe_robot(const RobotSources& robot, TextForm form);

/// One line per robot: name, number of joints, height, description, whether its maker states a
/// licence, and whether it is installed.
[[nodiscard]] Result<std::string> describe_robots(std::span<const RobotSources> robots,
                                                  TextForm form);

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

/// Robots to install, with their source and destination.
struct RobotsToInstall {
  /// Full names; empty: all robots of the source that are not installed yet.
  std::vector<std::string> names;
  /// A folder or a ZIP archive with robots as subfolders of `robots` or `unverified`, optionally
  /// below a top-level folder of the archive. In a folder, robots may also be direct subfolders.
  std::filesystem::path source;
  /// Destination folder; empty: the user's (user_data_folder), where robots without a stated
  /// licence are installed in `unverified`.
  std::filesystem::path into;
  bool replace = false;                     ///< Replace existing robots of the same names.
  std::vector<std::string> installed = {};  ///< Robots that are skipped unless `names` lists them.
};

/// Copies robots and checks that each one loads.
///
/// Errors: kUsage: a source that is neither a folder nor a ZIP archive, has no robots, or lacks one
///   of the names; a robot that already exists. kConfig: a robot that cannot be loaded, or whose
///   robot.json has another name; robots copied before it remain. kRun: a folder that cannot be
///   written.
/// @return the folders, in the order of the names.
[[nodiscard]] Result<std::vector<std::filesystem::path>> install_robots(
    const RobotsToInstall& request);

}  // namespace retarget
