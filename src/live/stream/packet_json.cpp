#include "live/stream/packet_json.h"

#include <fmt/format.h>

#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostValues = 20'000;
constexpr std::size_t kMostDepth = 32;

// Stops scanning as soon as a bound is exceeded.
Result<void> check_bounds(std::string_view text, const std::string& what) {
  if (text.size() > kMostBytes) return input_failure({}, what + " exceeds one megabyte");
  std::size_t depth = 0, values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == ',' || c == ':' || c == '[' || c == '{') ++values;
    if (depth > kMostDepth) {
      return input_failure({},
                           fmt::format("{} is nested more than {} levels deep", what, kMostDepth));
    }
    if (values > kMostValues) {
      return input_failure({}, fmt::format("{} has more than {} values", what, kMostValues));
    }
  }
  return {};
}

}  // namespace

Result<PacketJson> parse_packet_json(std::string_view text, const std::string& what) {
  RETARGET_TRY(check_bounds(text, what));
  try {
    return PacketJson::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    return input_failure({}, fmt::format("{} is not JSON: byte {}", what, error.byte));
  } catch (const nlohmann::json::exception&) {
    return input_failure({}, what + " contains a number that is too large");
  }
}

}  // namespace retarget
