#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/robot/robot.h"

namespace retarget {

/// Loads a robot from an MJCF file and, unless the path is empty, a profile.
///
/// Mesh geoms and all assets are dropped before compiling, so no mesh file is needed. MuJoCo's
/// warnings and errors become ours (kConfig); nothing is printed. The model must have one free
/// joint, its first; ball joints are refused. Faults of the profile are named all at once.
[[nodiscard]] Result<std::shared_ptr<const Robot>> load_robot(const std::string& model_path,
                                                              const std::string& profile_path = {});

/// The files of a robot that is named or given by its folder.
struct RobotFiles {
  std::filesystem::path model;
  std::filesystem::path profile;
};

/// @param name_or_folder  a robot in `robots_folder` or a folder with model and profile.
/// An unknown name suggests the nearest one and lists all.
[[nodiscard]] Result<RobotFiles> find_robot(const std::string& name_or_folder,
                                            const std::filesystem::path& robots_folder);

/// Names of the robots in a folder, sorted.
[[nodiscard]] std::vector<std::string> list_robots(const std::filesystem::path& robots_folder);

}  // namespace retarget
