#include "robot_mapping.h"

#include <system_error>

namespace retarget::cli {

Result<std::string> find_mapping(const std::filesystem::path& robot_folder,
                                 const std::filesystem::path& configs, const std::string& robot) {
  const std::filesystem::path own = robot_folder / "ik.json";
  const std::filesystem::path shared = configs / ("lafan1_to_" + robot + ".json");
  std::error_code ignored;
  for (const std::filesystem::path& path : {own, shared}) {
    if (std::filesystem::is_regular_file(path, ignored)) return path.string();
  }
  return config_failure("",
                        "there is no mapping for the robot \"" + robot + "\": neither " +
                            own.string() + " nor " + shared.string(),
                        "add --ik-config FILE");
}

}  // namespace retarget::cli
