#include "base/plain_name.h"

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
  // the system's calls would end at a zero byte and see another path
  if (path.empty() || path.find('\0') != std::string_view::npos) return false;
  const fs::path parts(path);
  return parts.is_relative() && std::ranges::find(parts, "..") == parts.end() &&
         parts.lexically_normal() != ".";
}

bool lies_in(const fs::path& folder, std::string_view path) {
  if (!is_plain_path(path)) return false;
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return false;
  const fs::path found = fs::weakly_canonical(root / fs::path(path), error);
  if (error) return false;
  const auto [root_end, end] = std::ranges::mismatch(root, found);
  return root_end == root.end();
}

}  // namespace retarget
