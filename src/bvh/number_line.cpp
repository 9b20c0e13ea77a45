#include "bvh/number_line.h"

#include "bvh/number_parser.h"
#include "bvh/source_text.h"

namespace retarget {

std::size_t read_number_line_portable(std::string_view text, std::size_t begin, std::size_t count,
                                      std::span<double> row) {
  const char* const end = text.data() + text.size();
  const char* at = text.data() + begin;
  const auto skip_blanks = [&] {
    while (at < end && is_space(*at) && !is_line_end(*at)) ++at;
  };
  for (std::size_t i = 0; i < count; ++i) {
    skip_blanks();
    const ParsedNumber number = parse_number(at, end);
    if (number.status != NumberStatus::kOk) return std::string_view::npos;
    at = number.end;
    if (at < end && !is_space(*at)) return std::string_view::npos;
    row[i] = number.value;
  }
  skip_blanks();
  if (at < end && !is_line_end(*at)) return std::string_view::npos;
  return static_cast<std::size_t>(at - text.data());
}

ReadNumberLine fastest_number_line_reader() {
  const ReadNumberLine reader = vector_number_line_reader();
  return reader != nullptr ? reader : read_number_line_portable;
}

}  // namespace retarget
