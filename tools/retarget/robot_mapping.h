#pragma once

#include <filesystem>
#include <string>

#include "retarget/base/result.h"

namespace retarget::cli {

/// The mapping that comes with a robot: `ik.json` in its folder, else `lafan1_to_NAME.json` among
/// the mappings.
[[nodiscard]] Result<std::string> find_mapping(const std::filesystem::path& robot_folder,
                                               const std::filesystem::path& configs,
                                               const std::string& robot);

}  // namespace retarget::cli
