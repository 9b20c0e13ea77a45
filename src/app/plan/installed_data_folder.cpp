#include <filesystem>
#include <optional>
#include <string>

#include "base/try.h"
#include "retarget/data_folder.h"
#include "retarget/load.h"

#ifdef RETARGET_DATA_FROM_LIBRARY
#include <dlfcn.h>

#include <system_error>
#endif

namespace retarget {

#ifdef RETARGET_DATA_FROM_LIBRARY

// A shared library finds its own installation tree, even if the tree was moved.
std::string installed_data_folder() {
  static constexpr char kHere = 0;
  Dl_info library{};
  if (dladdr(&kHere, &library) == 0 || library.dli_fname == nullptr) return {};
  std::error_code unknown;
  const auto file = std::filesystem::weakly_canonical(library.dli_fname, unknown);
  if (unknown) return {};
  return (file.parent_path() / RETARGET_DATA_FROM_LIBRARY).lexically_normal().string();
}

#else

// A static library is part of a program in an arbitrary folder. find_package(retarget) compiles a
// definition of this function into the program (cmake/package_data_folder.cpp.in), which replaces
// the weak one. Libraries of Windows have no weak functions; there the program's folder is enough.
#ifdef _WIN32
extern "C" const char* retarget_package_data_folder();
#else
extern "C" [[gnu::weak]] const char* retarget_package_data_folder();
#endif
const char* retarget_package_data_folder() {
  return "";
}

std::string installed_data_folder() {
  return retarget_package_data_folder();
}

#endif

Result<std::string> find_data_folder(const DataFolder& folder) {
  const std::optional<std::string> chosen =
      folder.chosen.empty() ? std::nullopt : std::optional(folder.chosen);
  TRY_ASSIGN(const std::filesystem::path found, find_data_folder(chosen, installed_data_folder()));
  return found.string();
}

}  // namespace retarget
