#include "retarget/file.h"

#include <algorithm>
#include <system_error>

namespace retarget {

namespace fs = std::filesystem;

bool is_plain_name(std::string_view name) {
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  };
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of("/\\") == std::string_view::npos &&
         std::ranges::none_of(name, is_control);
}

bool is_plain_path(std::string_view path) {
  // System calls would stop at a zero byte and use another path.
  if (path.empty() || path.find('\0') != std::string_view::npos) return false;
  const fs::path parts(path);
  return parts.is_relative() && std::ranges::find(parts, "..") == parts.end() &&
         parts.lexically_normal() != ".";
}

bool is_below(const fs::path& file, const fs::path& folder) {
  std::error_code of_file, of_folder;
  const fs::path found = fs::weakly_canonical(file, of_file);
  const fs::path root = fs::weakly_canonical(folder, of_folder);
  if (of_file || of_folder) return false;
  return std::ranges::mismatch(root, found).in1 == root.end();
}

bool lies_in(const fs::path& folder, std::string_view path) {
  std::error_code error;
  return is_plain_path(path) && fs::exists(folder, error) &&
         is_below(folder / fs::path(path), folder);
}

}  // namespace retarget
