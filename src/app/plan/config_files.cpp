#include "retarget/check_options.h"

#include <algorithm>
#include <system_error>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/robots.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

constexpr const char* kPublished = "published";
constexpr const char* kDerived = "derived";
constexpr const char* kConfigHint = OPTION(
    "ik-config") " FILE uses your own retargeting configuration; retarget robots add creates a "
    "robot with one";

// An inaccessible file is an error, not a missing file: otherwise another file would replace it.
Result<void> check_look(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::status_known(status)) return {};
  return config_failure(path.string(), "cannot access the file: " + error.message());
}

// Whether this is an installed robot, and not one with the same name from elsewhere.
bool is_of_folders(const fs::path& robot_folder, const RobotFolders& folders) {
  const fs::path parent =
      robot_folder.parent_path().empty() ? fs::path(".") : robot_folder.parent_path();
  std::error_code ignored;
  return std::ranges::any_of(folders, [&](const fs::path& robots) {
    return fs::equivalent(parent, robots, ignored) ||
           fs::equivalent(parent, robots / "unverified", ignored);
  });
}

}  // namespace

bool is_config_kind(const std::string& ik_config) {
  return ik_config == kPublished || ik_config == kDerived;
}

Result<ConfigFiles> find_configs(const std::string& ik_config, Method method,
                                 const fs::path& robot_folder, const fs::path& data_folder,
                                 const std::string& robot) {
  if (!ik_config.empty() && !is_config_kind(ik_config)) return ConfigFiles{ik_config, {}};
  const fs::path own = robot_folder / "ik.json";
  const fs::path published = data_folder / "configs" / ("lafan1_to_" + robot + ".json");
  for (const fs::path& path : {own, published}) {
    TRY(check_look(path));
  }
  if (!ik_config.empty()) {
    const fs::path& chosen = ik_config == kPublished ? published : own;
    const fs::path& other = ik_config == kPublished ? own : published;
    if (is_file(chosen)) return ConfigFiles{chosen.string(), {}};
    return config_failure(
        "",
        "no " + ik_config + " retargeting configuration for the robot \"" + robot + "\": no " +
            chosen.string(),
        is_file(other) ? std::string(OPTION("ik-config") " ") +
                             (ik_config == kPublished ? kDerived : kPublished) +
                             " selects the existing one, " OPTION("ik-config") " FILE your own"
                       : kConfigHint);
  }
  if (method == Method::kGmr && is_file(own) && is_file(published) &&
      is_of_folders(robot_folder, robot_folders(data_folder))) {
    return ConfigFiles{published.string(), own.string()};
  }
  for (const fs::path& path : {own, published}) {
    if (is_file(path)) return ConfigFiles{path.string(), {}};
  }
  return config_failure("",
                        "no retargeting configuration for the robot \"" + robot + "\": neither " +
                            own.string() + " nor " + published.string(),
                        kConfigHint);
}

std::string recorded_name(const fs::path& path, const fs::path& data_folder) {
  const fs::path relative = path.lexically_relative(data_folder);
  const bool below = !relative.empty() && *relative.begin() != "..";
  return below ? relative.generic_string() : path.string();
}

}  // namespace retarget
