#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>

namespace retarget {

/// The folder of real clips and reference figures that is not part of the repository: where
/// RETARGET_SHARED points, else `shared` beside the source tree. Tests that need it skip without.
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
