#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// The folders to search for robots, including their `unverified` subfolders; earlier folders take
/// precedence.
using RobotFolders = std::vector<std::filesystem::path>;

/// Returns the robot folders of a data folder, then those of the user (user_data_folder).
[[nodiscard]] RobotFolders robot_folders(const std::filesystem::path& data_folder);

/// A robot that the project knows, installed or not.
struct KnownRobot {
  std::string name;
  std::string description;
  std::string licence;      ///< As stated in its robot.json.
  bool in_packages = true;  ///< True if the licence permits distribution in every install.
};

/// Returns the robots listed in the folders' index.json files, sorted by name. A folder without the
/// file adds none; an invalid file is an error of kind kConfig.
[[nodiscard]] Result<std::vector<KnownRobot>> known_robots(const RobotFolders& folders);

}  // namespace retarget
