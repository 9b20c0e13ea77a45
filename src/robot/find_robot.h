#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// The files of a robot.
struct RobotFiles {
  std::filesystem::path model;    ///< `model.xml` of the robot's folder.
  std::filesystem::path profile;  ///< Its `robot.json`; empty when the folder has none.
  /// What names it: the whole name of a robot that was named by a short one, else as given.
  std::string name;
};

/// The files of a robot that is named or given by its folder.
///
/// @param name_or_folder  a robot in `robots_folder` or its `unverified`, else a folder with a
/// model, else a short name:
///   words of one robot's name (`g1`, `toddy`, `adam-lite`), in any letter case. Names that end with
///   the words go before others: `g1` is unitree_g1 and not unitree_g1_with_hands.
/// Errors (kConfig): an unknown name suggests the nearest one and lists all, a short name of
/// several robots lists these; a folder without a model says which file it lacks.
[[nodiscard]] Result<RobotFiles> find_robot(const std::string& name_or_folder,
                                            const std::filesystem::path& robots_folder);

/// Whether a robot lies in `unverified`, among those whose makers state no licence (docs/robots.md).
[[nodiscard]] bool is_unverified(const std::filesystem::path& model);

/// Names of the robots in a folder and in its `unverified`, sorted: the folders in them that hold a
/// `model.xml`. Empty for a folder that is not there.
[[nodiscard]] std::vector<std::string> list_robots(const std::filesystem::path& robots_folder);

}  // namespace retarget
