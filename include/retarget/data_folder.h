#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The data folder holds robots/ and configs/. Most programs need none of this: load_robot and
/// load_clip search for it.

/// Places to search for the data folder; see find_data_folder.
struct DataFolderSearch {
  std::optional<std::string> flag;         ///< The user's choice.
  std::optional<std::string> environment;  ///< RETARGET_DATA_DIR; empty counts as not set.
  std::filesystem::path executable;  ///< The running binary with links resolved; may be empty.
  std::string installed = {};        ///< Data folder of the installed library; empty when unknown.
};

/// Finds the folder that holds robots/ and configs/. The search order is:
///
/// 1. The flag.
/// 2. The environment variable. A folder named by 1 or 2 must hold both; otherwise it is an error
///    and the search stops, because the user chose that folder.
/// 3. `<executable's folder>/../share/retarget`: the installed tree, which is relocatable.
/// 4. The data folder of the installed library, for programs that link it.
/// 5. The source tree in which the executable was built: the nearest folder above the executable
///    that holds robots/, configs/ and include/retarget/.
///
/// No path of the build machine is compiled in. Errors are of kind kConfig.
[[nodiscard]] Result<std::filesystem::path> find_data_folder(const DataFolderSearch& search);

/// find_data_folder with the environment and the executable of this process.
[[nodiscard]] Result<std::filesystem::path> find_data_folder(
    const std::optional<std::string>& chosen_by_flag, const std::string& installed = {});

/// The folder for the user's own data: `$XDG_DATA_HOME/retarget`, otherwise
/// `$HOME/.local/share/retarget`. It may not exist. Returns nothing when neither variable is an
/// absolute path.
[[nodiscard]] std::optional<std::filesystem::path> user_data_folder();

}  // namespace retarget
