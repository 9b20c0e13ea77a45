#include "batch/clip_variants.h"

#include <filesystem>

#include "retarget/text.h"

namespace retarget {

namespace fs = std::filesystem;

std::string part_text(const std::string& start, const std::string& end) {
  return start.empty() && end.empty() ? std::string() : start + ":" + end;
}

PartOptions part_options(const std::string& part) {
  PartOptions options;
  if (part.empty()) return options;
  const std::size_t colon = part.find(':');
  const std::string start = part.substr(0, colon), end = part.substr(colon + 1);
  if (start.starts_with('f') || end.starts_with('f')) {
    const auto frame = [](const std::string& text) { return text.empty() ? text : text.substr(1); };
    options.frames = frame(start) + ":" + frame(end);
    return options;
  }
  options.start_s = parse_number<double>(start).value_or(-1.0);
  options.end_s = parse_number<double>(end).value_or(-1.0);
  return options;
}

std::string mirrored_name(const std::string& relative) {
  const fs::path path(relative);
  const std::string name = path.stem().string() + "_mirrored" + path.extension().string();
  return path.has_parent_path() ? (path.parent_path() / name).string() : name;
}

}  // namespace retarget
