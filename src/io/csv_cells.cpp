#include "io/csv_cells.h"

#include <charconv>
#include <system_error>

namespace retarget {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

bool is_mark(char c) {
  return c == ',' || c == ';';
}

}  // namespace

void split_cells(std::string_view line, std::vector<CsvCell>& cells) {
  cells.clear();
  std::size_t at = 0;
  const auto skip_blanks = [&] {
    while (at < line.size() && is_blank(line[at])) ++at;
  };
  skip_blanks();
  while (at < line.size()) {
    const std::size_t begin = at;
    while (at < line.size() && !is_blank(line[at]) && !is_mark(line[at])) ++at;
    cells.push_back({line.substr(begin, at - begin), begin});
    skip_blanks();
    if (at == line.size() || !is_mark(line[at])) continue;
    ++at;
    skip_blanks();
    // after a last comma there is a cell still, an empty one
    if (at == line.size()) cells.push_back({{}, at});
  }
}

std::optional<double> number_of_cell(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace retarget
