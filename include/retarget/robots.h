#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The folders to search for robots, including their `unverified` subfolders; earlier folders take
/// precedence.
using RobotFolders = std::vector<std::filesystem::path>;

/// Returns the robot folders of a data folder, then those of the user (user_data_folder).
[[nodiscard]] RobotFolders robot_folders(const std::filesystem::path& data_folder);

/// A robot that the project knows, installed or not.
struct KnownRobot {
  std::string name;
  std::string description;
  std::string licence;      ///< Licence stated in its robot.json.
  bool in_packages = true;  ///< True if the licence permits distribution in every install.
};

/// Returns the robots listed in the folders' index.json files, sorted by name. A folder without the
/// file adds none; an invalid file is an error of kind kConfig.
[[nodiscard]] Result<std::vector<KnownRobot>> known_robots(const RobotFolders& folders);

/// The files of a robot.
struct RobotFiles {
  std::filesystem::path model;    ///< `model.xml` of the robot's folder.
  std::filesystem::path profile;  ///< Its `robot.json`; empty when the folder has none.
  /// The robot's full name if it was found by name; the folder if one was given.
  std::string name;
  /// Names another robot that the given name may mean, in the current folder or among the known
  /// robots; empty: there is none.
  std::string warning = {};
};

/// Finds the files of a robot given by its name or its folder.
///
/// @param name_or_folder  a robot in one of the folders, otherwise a folder with a model (the only
///   meaning of a path with a separator, such as `./unitree_g1`), otherwise a short name: words of
///   one robot's name (`g1`, `toddy`, `adam-lite`), in any letter case. Names that end with the
///   words take precedence: `g1` matches unitree_g1 but not unitree_g1_with_hands. Short names are
///   matched against all known robots, so that a name has the same meaning in every install; the
///   full name of a robot is never completed to another.
/// Errors (kConfig): a known robot that is not installed is named, with installation instructions;
///   an ambiguous short name lists its matches; an unknown name suggests the nearest one and lists
///   all; a folder without a model reports the missing file.
[[nodiscard]] Result<RobotFiles> find_robot(const std::string& name_or_folder,
                                            const RobotFolders& folders);

/// Returns true if find_robot finds a robot, or knows one of that name that is not installed.
[[nodiscard]] bool names_robot(const std::string& name_or_folder, const RobotFolders& folders);

/// Explains how to install a known robot.
[[nodiscard]] std::string install_hint(const std::string& robot);

/// Returns true if a model lies in `unverified`, the folder of robots without a stated licence
/// (docs/robots.md).
[[nodiscard]] bool is_unverified(const std::filesystem::path& model);

/// Returns the sorted names of the robots in the folders and in their `unverified` subfolders:
/// every subfolder that holds a `model.xml`. Folders that do not exist are ignored.
[[nodiscard]] std::vector<std::string> list_robots(const RobotFolders& folders);

}  // namespace retarget
