#include "formats/bvh/motion_rows.h"

#include <charconv>
#include <string_view>
#include <system_error>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/bvh/number_parser.h"

namespace retarget {
namespace {

constexpr const char* kFrameTimeHint = "give the rate with " OPTION("source-fps") " N";

// Skips the colon of a keyword, up to the value on the same line.
void skip_to_value(Scanner& scanner) {
  scanner.skip_blanks();
  scanner.take(':');
  scanner.skip_blanks();
}

Result<std::int64_t> parse_frame_count(const SourceText& source, Scanner& scanner) {
  const std::string_view token = scanner.token();
  std::int64_t frames = 0;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, frames);
  if (error != std::errc() || stop != end || frames < 0) {
    return source.unexpected_at(scanner.offset(), "the frame count, a whole number");
  }
  scanner.move_to(scanner.offset() + token.size());
  return frames;
}

Result<double> parse_frame_time(const SourceText& source, Scanner& scanner, bool needs_frame_time) {
  const std::string_view token = scanner.token();
  const std::size_t place = scanner.offset();
  const char* end = token.data() + token.size();
  const ParsedNumber number = parse_number(token.data(), end);
  if (number.status != NumberStatus::kOk || number.end != end) {
    return number_failure(source, place, "the frame time in seconds");
  }
  if (needs_frame_time && !(number.value > 0.0)) {
    return source.unexpected_at(place, "a frame time above 0 seconds", kFrameTimeHint);
  }
  scanner.move_to(place + token.size());
  return number.value;
}

}  // namespace

Result<MotionHeader> parse_motion_header(const SourceText& source, Scanner& scanner,
                                         bool needs_frame_time) {
  MotionHeader header;
  bool has_frames = false;
  while (true) {
    scanner.skip_space();
    const std::size_t place = scanner.offset();
    const std::string_view word = scanner.word();
    if (!has_frames && equal_ignoring_case(word, "Frames")) {
      scanner.move_to(place + word.size());
      skip_to_value(scanner);
      header.frames_place = scanner.offset();
      TRY_ASSIGN(header.frames, parse_frame_count(source, scanner));
      has_frames = true;
    } else if (!header.frame_time && equal_ignoring_case(word, "Frame")) {
      scanner.move_to(place + word.size());
      scanner.skip_blanks();
      if (const std::string_view second = scanner.word(); !equal_ignoring_case(second, "Time")) {
        return source.unexpected_at(scanner.offset(), "Time: after Frame");
      }
      scanner.move_to(scanner.offset() + 4);
      skip_to_value(scanner);
      header.frame_time_place = scanner.offset();
      TRY_ASSIGN(header.frame_time, parse_frame_time(source, scanner, needs_frame_time));
    } else {
      if (!has_frames) return source.unexpected_at(place, "Frames: and a count");
      if (!header.frame_time && needs_frame_time) {
        return source.unexpected_at(place, "Frame Time: and seconds", kFrameTimeHint);
      }
      return header;
    }
  }
}

}  // namespace retarget
