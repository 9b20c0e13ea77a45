#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace retarget {

/// Whether a text that a file holds can be the name of a file or folder and nothing else: one part,
/// neither `.` nor `..`, without control characters.
[[nodiscard]] bool is_plain_name(std::string_view name);

/// Whether a text that a file holds names something below a folder, as far as the text alone tells:
/// a relative path without `..`. Every other character may be in it.
[[nodiscard]] bool is_plain_path(std::string_view path);

/// Whether a file is in a folder or below it when links are followed; the folder itself counts.
[[nodiscard]] bool is_below(const std::filesystem::path& file, const std::filesystem::path& folder);

/// Whether a plain path below a folder lies there as well when links are followed. The last part
/// need not exist.
[[nodiscard]] bool lies_in(const std::filesystem::path& folder, std::string_view path);

}  // namespace retarget
