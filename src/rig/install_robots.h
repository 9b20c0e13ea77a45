#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget {

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
