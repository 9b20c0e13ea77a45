#include <array>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>

#include "batch/manifest.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::int64_t kMsPerSecond = 1000;

// Formats milliseconds since 1970 as 2026-01-31T12:00:00.000Z.
std::string utc_text(std::int64_t ms) {
  const auto seconds = static_cast<std::time_t>(ms / kMsPerSecond);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return std::string(text.data(), length) + "." +
         std::to_string(kMsPerSecond + ms % kMsPerSecond).substr(1) + "Z";
}

// Parses the format of utc_text, with or without milliseconds. Returns nothing for other text.
std::optional<std::int64_t> ms_of(const std::string& text) {
  std::tm parts{};
  const char* end = ::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (end == nullptr || !text.ends_with('Z')) return std::nullopt;
  const std::string_view rest(end);
  const bool whole = rest == "Z";
  if (!whole && !rest.starts_with('.')) return std::nullopt;
  const auto ms =
      whole ? std::optional(0U) : parse_number<unsigned>(rest.substr(1, rest.size() - 2));
  if (!ms || *ms >= kMsPerSecond) return std::nullopt;
  return static_cast<std::int64_t>(::timegm(&parts)) * kMsPerSecond + *ms;
}

}  // namespace

std::string finished_after(std::int64_t now_ms, const std::string& earlier) {
  const auto known = ms_of(earlier);
  return utc_text(known && *known >= now_ms ? *known + 1 : now_ms);
}

}  // namespace retarget
