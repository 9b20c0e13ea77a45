#include "retarget/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Quotes in a quoted name are doubled.
std::string name_in(const CsvCell& cell) {
  std::string name(cell.text);
  for (std::size_t at = 0; (at = name.find("\"\"", at)) != std::string::npos; ++at) {
    name.erase(at, 1);
  }
  return name;
}

// No robot motion has larger numbers in any unit.
constexpr double kMaxNumber = 1e6;
// Nanoseconds since 1970 are smaller.
constexpr double kMaxTime = 1e20;

// Whether a cell looks like a number, valid or not. Names never begin this way.
bool begins_as_number(std::string_view text) {
  const std::size_t first = text.find_first_not_of("+-.");
  return first != std::string_view::npos && text[first] >= '0' && text[first] <= '9';
}

// Parses a whole cell as a number.
std::optional<double> number_of_cell(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    // Reject `+-`.
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

class CsvTableReader {
 public:
  explicit CsvTableReader(const std::string& file) : file_(file) {}

  Result<CsvTable> read(std::string_view text) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
      return input_failure(file_, "the file is UTF-16 text", "save it as UTF-8");
    }
    text = without_byte_order_mark(text);
    const char line_end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
    const bool is_ended = text.ends_with(line_end);
    while (!text.empty()) {
      ++line_;
      TRY(read_line(take_until(text, line_end)));
    }
    if (table_.rows() == 0) return input_failure(file_, "the file has no frames");
    constexpr std::size_t kFewestRows = 4;
    table_.may_be_cut_off = !is_ended && table_.rows() >= kFewestRows && same_decimals_ &&
                            last_decimals_ < usual_decimals_;
    if (!table_.header.empty() && table_.header.size() != table_.columns) {
      return input_failure(file_, "the header has " + count_text(table_.header.size(), "column") +
                                      ", the lines " + std::to_string(table_.columns));
    }
    if (table_.comment.size() != table_.columns) table_.comment.clear();
    return std::move(table_);
  }

 private:
  [[nodiscard]] Failure fault(std::size_t column, std::string message,
                              std::string hint = {}) const {
    return failure(
        {ErrorKind::kInput, {file_, line_, column + 1}, std::move(message), {}, std::move(hint)});
  }

  Result<void> read_line(std::string_view line) {
    split_cells(line, cells_);
    if (cells_.empty()) return {};
    if (cells_.front().text.starts_with('#')) {
      if (!begun_) take_comment(line);
      return {};
    }
    const std::string_view first = cells_.front().text;
    if (!std::exchange(begun_, true) && !number_of_cell(first) && !begins_as_number(first)) {
      for (const CsvCell& cell : cells_) table_.header.push_back(name_in(cell));
      table_.comment.clear();
      return {};
    }
    return read_row();
  }

  void take_comment(std::string_view line) {
    const std::size_t begin = line.find_first_not_of("# \t\r");
    if (begin == std::string_view::npos) return;
    split_cells(line.substr(begin), cells_);
    table_.comment.clear();
    for (const CsvCell& cell : cells_) table_.comment.push_back(name_in(cell));
  }

  Result<void> read_row() {
    if (table_.rows() == 0) table_.columns = cells_.size();
    if (cells_.size() != table_.columns) {
      return fault(0, "this line has " + count_text(cells_.size(), "column") +
                          ", those before it " + std::to_string(table_.columns));
    }
    for (const CsvCell& cell : cells_) {
      const auto value = number_of_cell(cell.text);
      const std::string found(cell.text.substr(0, 40));
      if (!value) {
        return fault(
            cell.column, "expected a number, found \"" + found + "\"",
            found.find(',') == std::string::npos ? "" : "use a decimal point instead of a comma");
      }
      const bool first = &cell == &cells_.front();
      // Negated comparison: also rejects NaN.
      if (!(std::abs(*value) <= (first ? kMaxTime : kMaxNumber))) {
        return fault(cell.column, "the number " + found + " is out of range");
      }
      table_.values.push_back(*value);
    }
    table_.lines.push_back(line_);
    count_decimals(cells_.back().text);
    return {};
  }

  // Compares the last number of a line with those of the lines before it.
  void count_decimals(std::string_view number) {
    if (table_.rows() > 1) {
      same_decimals_ = table_.rows() == 2 || (same_decimals_ && last_decimals_ == usual_decimals_);
      usual_decimals_ = last_decimals_;
    }
    const std::size_t point = number.find('.');
    last_decimals_ = point == std::string_view::npos ? 0 : number.size() - point;
  }

  const std::string& file_;
  CsvTable table_;
  std::vector<CsvCell> cells_;
  std::size_t line_ = 0;  // One-based.
  bool begun_ = false;    // A line with cells has been read.
  // Of the last numbers of lines, with the point: in the last line, and in those before it.
  std::size_t last_decimals_ = 0, usual_decimals_ = 0;
  bool same_decimals_ = false;  // In all lines before the last one.
};

}  // namespace

Result<CsvTable> read_csv_table(std::string_view text, const std::string& file) {
  return CsvTableReader(file).read(text);
}

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

// Delimiter of a line. Semicolons take precedence over commas, which may be decimal commas.
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

// End of a quoted text that begins at `at`. A quote in the text is doubled.
std::size_t end_of_quotes(std::string_view line, std::size_t at) {
  std::size_t end = line.find('"', at + 1);
  while (end < line.size() && line.substr(end + 1).starts_with('"')) end = line.find('"', end + 2);
  return std::min(end, line.size() - 1) + 1;
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
    if (line[at] == '"') at = end_of_quotes(line, at);
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
  // A line that ends with a comma has an empty last cell.
  if (!cells.empty()) cells.push_back({{}, at});
}

}  // namespace retarget
