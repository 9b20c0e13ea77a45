#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/make_robot.h"
#include "retarget/options.h"

// Link retarget::rig.
namespace RETARGET_API retarget {

/// Checks names and paths before a robot is made from a model and saved `into` a folder. kUsage
/// errors: the name is not a valid folder name, the model is inside the robot's folder, and those
/// of save_robot.
[[nodiscard]] Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                                           const std::filesystem::path& into, bool force);

/// Writes the robot's folder into the folder `into`, completely or not at all. Creates `into`, but
/// not its parent. If the name already exists, `force` replaces it atomically, but only if it is a
/// folder whose robot.json make_robot wrote for a robot of this name. kUsage errors: the name
/// exists and cannot be replaced, it is not a valid folder name, the parent of `into` does not
/// exist.
/// @return the written folder.
[[nodiscard]] Result<std::filesystem::path> save_robot(const MadeRobot& robot,
                                                       const std::filesystem::path& into,
                                                       bool force);

/// Finds a robot by name or folder (find_robot), with its retargeting configurations.
/// Errors: those of find_robot.
[[nodiscard]] Result<RobotSources> find_robot_sources(const std::string& name_or_folder,
                                                      const std::string& data_folder);

/// The robot of a model file, with the `robot.json` and the retargeting configurations in the
/// model's folder. With a `robot.json`, the data folder may have a configuration as well.
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
/// licence, and whether it is installed. For a robot that cannot be loaded, its error.
[[nodiscard]] Result<std::string> describe_robots(std::span<const RobotSources> robots,
                                                  TextForm form);

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
