#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Hashes the names and contents of a folder's files.
/// @param ending  extension of the files to include, such as `.json`; empty: all.
[[nodiscard]] Result<std::string> folder_hash(const std::filesystem::path& folder,
                                              std::string_view ending);

}  // namespace retarget
