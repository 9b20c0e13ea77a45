#include "base/json.h"

#include <algorithm>

#include "retarget/base/file.h"

namespace retarget {
namespace {

// nlohmann's text without its own prefix and position, which is counted anew below
std::string reason_of(const nlohmann::json::parse_error& error) {
  std::string reason = error.what();
  if (const auto colon = reason.rfind("column "); colon != std::string::npos) {
    const auto start = reason.find(": ", colon);
    if (start != std::string::npos) reason.erase(0, start + 2);
  }
  return reason;
}

}  // namespace

Result<nlohmann::ordered_json> parse_json(std::string_view text, const std::string& file) {
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::string_view before = text.substr(0, std::min(error.byte, text.size()));
    const std::size_t line_start = before.rfind('\n');
    Error failed;
    failed.kind = ErrorKind::kConfig;
    failed.file = file;
    failed.line = 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
    failed.column = std::max<std::size_t>(
        1, line_start == std::string_view::npos ? before.size() : before.size() - line_start - 1);
    failed.message = "no valid JSON: " + reason_of(error);
    return failure(std::move(failed));
  }
}

Result<nlohmann::ordered_json> load_json(const std::string& path) {
  const auto text = read_file(path, ErrorKind::kConfig);
  if (!text) return failure(text.error());
  return parse_json(*text, path);
}

}  // namespace retarget
