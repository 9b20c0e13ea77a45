#include "io/csv_cells.h"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace retarget {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

// the strongest mark of a line; a semicolon before a comma, which may be in its numbers
char mark_of(std::string_view line) {
  char mark = ' ';
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == ';') return c;
    if (c == ',' || (c == '\t' && mark == ' ')) mark = c;
  }
  return mark;
}

std::string_view without_blanks_behind(std::string_view text) {
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

void split_cells(std::string_view line, std::vector<CsvCell>& cells) {
  cells.clear();
  line = without_blanks_behind(line);
  const char mark = mark_of(line);
  const auto parts = [mark](char c) { return mark == ' ' ? is_blank(c) : c == mark; };
  std::size_t at = 0;
  const auto skip_blanks = [&] {
    while (at < line.size() && is_blank(line[at])) ++at;
  };
  skip_blanks();
  while (at < line.size()) {
    const std::size_t begin = at;
    if (line[at] == '"') at = std::min(line.find('"', at + 1), line.size() - 1) + 1;
    while (at < line.size() && !parts(line[at])) ++at;
    std::string_view text = without_blanks_behind(line.substr(begin, at - begin));
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
      text = without_blanks_behind(text.substr(1, text.size() - 2));
      while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    }
    cells.push_back({text, begin});
    if (at == line.size()) return;
    ++at;
    skip_blanks();
  }
  // after a last comma there is a cell still, an empty one
  if (!cells.empty()) cells.push_back({{}, at});
}

std::optional<double> number_of_cell(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    // one sign is enough
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace retarget
