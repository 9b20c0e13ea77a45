#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>

namespace retarget {

/// Folder of real clips and reference figures, which is not part of the repository:
/// RETARGET_SHARED, else `shared` next to the source tree. Tests that need it skip if it does not
/// exist.
inline std::optional<std::filesystem::path> shared_folder() {
  const char* chosen = std::getenv("RETARGET_SHARED");
  std::filesystem::path folder = chosen != nullptr
                                     ? std::filesystem::path(chosen)
                                     : std::filesystem::path(RETARGET_SOURCE_DIR) / ".." / "shared";
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) return std::nullopt;
  return folder;
}

inline constexpr const char* kNoSharedFolder =
    "no folder of shared data: set RETARGET_SHARED to run this test";

}  // namespace retarget
