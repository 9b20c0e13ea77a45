#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "base/data_folder.h"
#include "base/try.h"
#include "handles.h"

namespace retarget::python {

Result<std::string> data_folder_of(const std::string& chosen) {
  DataFolderSearch search;
  if (!chosen.empty()) search.flag = chosen;
  if (const char* value = std::getenv("RETARGET_DATA_DIR")) search.environment = value;
  // the package is laid out like an install, with this module above its bin/; in a build tree the
  // search goes on upwards
  Dl_info module{};
  static const char kHere = 0;
  if (dladdr(&kHere, &module) != 0 && module.dli_fname != nullptr) {
    std::error_code unknown;
    const auto file = std::filesystem::weakly_canonical(module.dli_fname, unknown);
    search.executable = file.parent_path() / "bin" / "retarget";
  }
  TRY_ASSIGN(const auto folder, find_data_folder(search));
  return folder.string();
}

}  // namespace retarget::python
