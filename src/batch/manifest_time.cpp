#include <array>
#include <charconv>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>

#include "batch/manifest.h"

namespace retarget {
namespace {

constexpr std::int64_t kMsPerSecond = 1000;

// milliseconds since 1970 as 2026-01-31T12:00:00.000Z
std::string utc_text(std::int64_t ms) {
  const auto seconds = static_cast<std::time_t>(ms / kMsPerSecond);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return std::string(text.data(), length) + "." +
         std::to_string(kMsPerSecond + ms % kMsPerSecond).substr(1) + "Z";
}

// the number that is all of a text
std::optional<int> digits(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number >= 0 ? std::optional(number) : std::nullopt;
}

// what utc_text made, with or without milliseconds; nothing for other texts
std::optional<std::int64_t> ms_of(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00";
  if (text.size() <= kForm.size() || text.back() != 'Z') return std::nullopt;
  std::tm parts{};
  const std::array<std::pair<std::size_t, int*>, 6> fields = {{{0, &parts.tm_year},
                                                               {5, &parts.tm_mon},
                                                               {8, &parts.tm_mday},
                                                               {11, &parts.tm_hour},
                                                               {14, &parts.tm_min},
                                                               {17, &parts.tm_sec}}};
  for (const auto& [begin, value] : fields) {
    const auto number = digits(text.substr(begin, begin == 0 ? 4 : 2));
    if (!number) return std::nullopt;
    *value = *number;
  }
  parts.tm_year -= 1900;
  parts.tm_mon -= 1;
  const std::string_view rest = text.substr(kForm.size(), text.size() - kForm.size() - 1);
  const auto ms = rest.empty() ? std::optional(0) : digits(rest.substr(1));
  if (!ms || *ms >= kMsPerSecond) return std::nullopt;
  return static_cast<std::int64_t>(::timegm(&parts)) * kMsPerSecond + *ms;
}

}  // namespace

std::string finished_after(std::int64_t now_ms, const std::string& earlier) {
  const auto known = ms_of(earlier);
  return utc_text(known && *known >= now_ms ? *known + 1 : now_ms);
}

}  // namespace retarget
