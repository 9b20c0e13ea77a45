#include "retarget/text.h"

#include <algorithm>

namespace retarget {
namespace {

// Counts UTF-8 characters: continuation bytes take no column.
std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned>(c) & 0xC0U) != 0x80U; }));
}

// Wraps one line, which contains no line end.
void append_wrapped(std::string& out, std::string_view line, std::size_t used, std::size_t indent,
                    std::size_t width) {
  // Keep the indentation of the line.
  std::size_t at = std::min(line.find_first_not_of(' '), line.size());
  out.append(line.substr(0, at));
  std::size_t column = used + at;
  while (at < line.size()) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::size_t next = std::min(line.find_first_not_of(' ', end), line.size());
    out.append(line.substr(at, end - at));
    column += columns_of(line.substr(at, end - at));
    if (next == line.size()) return;
    const std::string_view word =
        line.substr(next, std::min(line.find(' ', next), line.size()) - next);
    const std::size_t blanks = next - end;
    if (column + blanks + columns_of(word) > width) {
      out += '\n';
      out.append(indent, ' ');
      column = indent;
    } else {
      out.append(blanks, ' ');
      column += blanks;
    }
    at = next;
  }
}

}  // namespace

std::string wrapped_text(std::string_view text, std::size_t used, std::size_t indent,
                         std::size_t width) {
  std::string out;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    append_wrapped(out, text.substr(begin, end - begin), begin == 0 ? used : 0, indent, width);
    if (end == text.size()) return out;
    out += '\n';
    begin = end + 1;
  }
}

}  // namespace retarget
