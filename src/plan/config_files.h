#pragma once

#include <filesystem>
#include <string>

#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Files of the configurations that runs to one robot use.
struct ConfigFiles {
  std::string of_lafan1;  ///< For clips in LAFAN1's shape, and for all where there is no other.
  std::string of_others;  ///< For all other clips; empty: the same.
};

/// Whether SolveOptions::ik_config names a kind of configuration, `published` or `derived`, and no file.
[[nodiscard]] bool is_config_kind(const std::string& ik_config);

/// The configurations that options choose for a robot.
///
/// A robot may have two: `lafan1_to_NAME.json` in configs/, the published method's, and `ik.json`
/// in its folder, derived from its model. With no choice the latter comes first; but the published
/// method keeps the published one for LAFAN1 and the robots of the data folder, where results are
/// compared with published ones. kConfig error: there is none.
/// @param ik_config  `published`, `derived`, a file, or nothing.
/// @param robot      name of the robot.
[[nodiscard]] Result<ConfigFiles> find_configs(const std::string& ik_config, Method method,
                                               const std::filesystem::path& robot_folder,
                                               const std::filesystem::path& data_folder,
                                               const std::string& robot);

/// The name under which a file is recorded: below the data folder relative to it, so that an
/// installed tool and a source tree say the same.
[[nodiscard]] std::string recorded_name(const std::filesystem::path& path,
                                        const std::filesystem::path& data_folder);

}  // namespace retarget
