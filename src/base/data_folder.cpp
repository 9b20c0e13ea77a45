#include "retarget/data_folder.h"
#include "base/option_name.h"
#include "retarget/os.h"

#include <cstdlib>
#include <system_error>

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr char kVariable[] = "RETARGET_DATA_DIR";

bool has_folder(const fs::path& folder, const char* name) {
  std::error_code not_there;
  return fs::is_directory(folder / name, not_there);
}

bool holds_data(const fs::path& folder) {
  return has_folder(folder, "robots") && has_folder(folder, "configs");
}

Result<fs::path> chosen_folder(const std::string& folder, const char* chosen_by) {
  for (const char* part : {"robots", "configs"}) {
    if (!has_folder(folder, part)) {
      return config_failure(folder, std::string("the data folder given by ") + chosen_by +
                                        " has no folder " + part + "/");
    }
  }
  return fs::path(folder);
}

}  // namespace

Result<fs::path> find_data_folder(const DataFolderSearch& search) {
  if (search.flag) return chosen_folder(*search.flag, OPTION("data-dir"));
  if (search.environment && !search.environment->empty()) {
    return chosen_folder(*search.environment, kVariable);
  }

  const fs::path binaries = search.executable.parent_path();
  if (!binaries.empty()) {
    const fs::path installed = (binaries / ".." / "share" / "retarget").lexically_normal();
    if (holds_data(installed)) return installed;
  }
  if (!search.installed.empty() && holds_data(search.installed)) return fs::path(search.installed);
  for (fs::path folder = binaries; !folder.empty(); folder = folder.parent_path()) {
    if (holds_data(folder) && has_folder(folder / "include", "retarget")) return folder;
    if (folder == folder.parent_path()) break;
  }
  return config_failure(
      "", "no data folder with robots/ and configs/ found relative to the program",
      std::string("set it with " OPTION("data-dir") " DIR or the environment variable ") +
          kVariable);
}

Result<fs::path> find_data_folder(const std::optional<std::string>& chosen_by_flag,
                                  const std::string& installed) {
  DataFolderSearch search;
  search.installed = installed;
  search.flag = chosen_by_flag;
  if (const char* value = std::getenv(kVariable)) search.environment = value;
  search.executable = os::program_file();
  return find_data_folder(search);
}

std::optional<fs::path> user_data_folder() {
  const auto data = os::folder_of_user_data();
  return data ? std::optional(*data / "retarget") : std::nullopt;
}

}  // namespace retarget
