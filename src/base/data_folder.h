#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "retarget/error.h"

namespace retarget {

/// Where to look for the data folder; see find_data_folder.
struct DataFolderSearch {
  std::optional<std::string> flag;         ///< What the user gave with --data-dir.
  std::optional<std::string> environment;  ///< RETARGET_DATA_DIR; empty counts as not set.
  std::filesystem::path executable;        ///< The running binary, links followed; may be empty.
  std::string installed = {};              ///< Of the installed library; empty: not known.
};

/// The folder that holds robots/ and configs/. The first of these counts:
///
/// 1. the flag, 2. the environment; one that does not hold both is an error, and nothing else is
///    looked at: who named a folder means that one;
/// 3. `<executable's folder>/../share/retarget`, the installed tree, which may lie anywhere;
/// 4. the source tree that the executable was built in: the nearest folder above the executable
///    that holds robots/, configs/ and include/retarget/.
///
/// 5. where find_package(retarget) found it, for programs that link an installed library.
///
/// No path of the building machine is compiled in. Errors are of kind kConfig.
[[nodiscard]] Result<std::filesystem::path> find_data_folder(const DataFolderSearch& search);

/// The same with the environment and the executable of this process.
[[nodiscard]] Result<std::filesystem::path> find_data_folder(
    const std::optional<std::string>& chosen_by_flag, const std::string& installed = {});

}  // namespace retarget
