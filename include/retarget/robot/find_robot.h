#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/base/result.h"

namespace retarget {

/// The files of a robot.
struct RobotFiles {
  std::filesystem::path model;    ///< `model.xml` of the robot's folder.
  std::filesystem::path profile;  ///< Its `robot.json`; empty when the folder has none.
};

/// The files of a robot that is named or given by its folder.
///
/// @param name_or_folder  a robot in `robots_folder`, else a folder with a model.
/// Errors (kConfig): an unknown name suggests the nearest one and lists all; a folder without a
/// model says which file it lacks.
[[nodiscard]] Result<RobotFiles> find_robot(const std::string& name_or_folder,
                                            const std::filesystem::path& robots_folder);

/// Names of the robots in a folder, sorted: the folders in it that hold a `model.xml`. Empty for a
/// folder that is not there.
[[nodiscard]] std::vector<std::string> list_robots(const std::filesystem::path& robots_folder);

}  // namespace retarget
