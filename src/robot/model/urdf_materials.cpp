#include "robot/model/urdf_materials.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace retarget {
namespace {

bool is_material(std::string_view text) {
  constexpr std::string_view kStart = "<material";
  constexpr std::string_view kAfterName = " \t\r\n/>";
  return text.starts_with(kStart) && text.size() > kStart.size() &&
         kAfterName.find(text[kStart.size()]) != std::string_view::npos;
}

}  // namespace

std::string without_materials(std::string text) {
  constexpr std::size_t kNone = std::string::npos;
  std::size_t at = text.find('<');
  while (at != kNone) {
    const std::string_view rest = std::string_view(text).substr(at);
    std::size_t end = at;
    if (rest.starts_with("<!--")) {
      end = text.find("-->", at);
    } else if (is_material(rest)) {
      end = text.find('>', at);
      const bool has_content = end != kNone && text[end - 1] != '/';
      if (has_content) end = text.find("</material", end);
      if (has_content && end != kNone) end = text.find('>', end);
      if (end == kNone) break;
      std::replace_if(
          text.begin() + static_cast<std::ptrdiff_t>(at),
          text.begin() + static_cast<std::ptrdiff_t>(end + 1), [](char c) { return c != '\n'; },
          ' ');
    }
    if (end == kNone) break;
    at = text.find('<', end + 1);
  }
  return text;
}

}  // namespace retarget
