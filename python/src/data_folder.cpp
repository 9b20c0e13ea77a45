#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>

#include "handles.h"
#include "retarget/data_folder.h"
#include "retarget/load.h"
#include "retarget/try.h"

namespace retarget::python {

Result<std::string> data_folder_of(const std::string& chosen) {
  DataFolderSearch search;
  search.installed = installed_data_folder();
  if (!chosen.empty()) search.flag = chosen;
  if (const char* value = std::getenv("RETARGET_DATA_DIR")) search.environment = value;
  // The package has the layout of an install, with this module in the folder that contains bin/. In
  // a build tree, the search continues upwards.
  Dl_info module{};
  static const char kHere = 0;
  if (dladdr(&kHere, &module) != 0 && module.dli_fname != nullptr) {
    std::error_code unknown;
    const auto file = std::filesystem::weakly_canonical(module.dli_fname, unknown);
    search.executable = file.parent_path() / "bin" / "retarget";
  }
  RETARGET_TRY_ASSIGN(const auto folder, find_data_folder(search));
  return folder.string();
}

}  // namespace retarget::python
