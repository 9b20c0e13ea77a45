#include "retarget/clip_range.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <system_error>

#include "base/option_name.h"
#include "base/try.h"

namespace retarget {
namespace {

// Tolerance of times, in frames.
constexpr double kTimeTolerance = 1e-6;

Failure bad_range(std::string_view text) {
  return usage_failure("the frame range \"" + std::string(text) + "\" does not have the form a:b",
                       "frames are numbered from 0 and b is excluded: 0:300, 120: or :300");
}

// Returns "no frames" or, for example, "frames 0 to 299".
std::string extent_text(int frame_count) {
  if (frame_count == 0) return "no frames";
  return "frames 0 to " + std::to_string(frame_count - 1);
}

// Parses an unsigned integer; empty text gives `fallback`. Returns nothing for other text. Numbers
// that do not fit into int are clamped.
std::optional<int> parse_bound(std::string_view text, int fallback) {
  if (text.empty()) return fallback;
  const bool digits = std::ranges::all_of(text, [](char c) { return '0' <= c && c <= '9'; });
  if (!digits) return std::nullopt;
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? value : std::numeric_limits<int>::max();
}

// Formats without trailing zeros, independently of the locale.
std::string seconds_text(double seconds) {
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), seconds, std::chars_format::general, 9);
  return std::string(text.data(), error == std::errc() ? end : text.data()) + " s";
}

Result<void> check_time(std::optional<double> time, const std::string& name) {
  if (!time || (std::isfinite(*time) && *time >= 0.0)) return {};
  return usage_failure("the " + name + " at " + seconds_text(*time) + " is not a valid time",
                       "times are in seconds from the first frame");
}

}  // namespace

Result<FrameRange> frame_range_from_text(std::string_view text, int frame_count) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return bad_range(text);
  const auto begin = parse_bound(text.substr(0, colon), 0);
  const auto end = parse_bound(text.substr(colon + 1), frame_count);
  if (!begin || !end) return bad_range(text);
  const std::string quoted = "the frame range \"" + std::string(text) + "\"";
  if (*begin >= frame_count) {
    return usage_failure(quoted + " begins after the end of the clip, which has " +
                         extent_text(frame_count));
  }
  if (*begin >= *end) {
    return usage_failure(quoted + " contains no frames",
                         "b is excluded; for a single frame, use a:b with b = a + 1");
  }
  return FrameRange{*begin, std::min(*end, frame_count)};
}

Result<FrameRange> frame_range_from_seconds(std::optional<double> start, std::optional<double> end,
                                            const FrameRate& rate, int frame_count) {
  TRY(check_time(start, "start"));
  TRY(check_time(end, "end"));
  if (start && end && *end < *start) {
    return usage_failure("the end at " + seconds_text(*end) + " comes before the start at " +
                         seconds_text(*start));
  }
  // Compares as real numbers first, because times may exceed any frame number.
  const double first = start ? std::ceil(*start * rate.fps() - kTimeTolerance) : 0.0;
  const double last = end ? std::floor(*end * rate.fps() + kTimeTolerance) : frame_count - 1.0;
  if (start && first >= frame_count) {
    const std::string extent = frame_count == 0
                                   ? "has no frames"
                                   : "ends at " + seconds_text(rate.time_of(frame_count - 1));
    return usage_failure("the start at " + seconds_text(*start) +
                         " is after the end of the clip, which " + extent);
  }
  if (start && last < first) {
    return usage_failure("no frame lies between " + seconds_text(*start) + " and " +
                         seconds_text(*end));
  }
  return FrameRange{static_cast<int>(first),
                    static_cast<int>(std::min(last, frame_count - 1.0)) + 1};
}

Result<FrameRange> chosen_range(const PartOptions& part, const FrameRate& rate, int frame_count) {
  const auto given = [](double seconds) {
    return seconds < 0.0 ? std::nullopt : std::optional<double>(seconds);
  };
  const auto start = given(part.start_s), end = given(part.end_s);
  if (!start && !end) {
    if (part.frames.empty()) return FrameRange{0, frame_count};
    return frame_range_from_text(part.frames, frame_count);
  }
  if (part.frames.empty()) return frame_range_from_seconds(start, end, rate, frame_count);
  return usage_failure(
      OPTION("frames") " and " OPTION("start") "/" OPTION("end") " both choose a part of the clip",
      "give only one of them");
}

}  // namespace retarget
