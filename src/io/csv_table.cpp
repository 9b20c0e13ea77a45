#include "io/csv_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/number_text.h"
#include "base/try.h"
#include "io/csv_cells.h"

namespace retarget {
namespace {

// beyond this a number is no motion of a robot in any unit
constexpr double kMaxNumber = 1e6;
// nanoseconds since 1970 are below
constexpr double kMaxTime = 1e20;

// whether a cell is meant as a number, sound or not: no name begins so
bool begins_as_number(std::string_view text) {
  const std::size_t first = text.find_first_not_of("+-.");
  return first != std::string_view::npos && text[first] >= '0' && text[first] <= '9';
}

class CsvTableReader {
 public:
  explicit CsvTableReader(const std::string& file) : file_(file) {}

  Result<CsvTable> read(std::string_view text) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
      return input_failure(file_, "the file is UTF-16 text", "save it as UTF-8");
    }
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      ++line_;
      TRY(read_line(text.substr(0, end)));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (table_.rows() == 0) return input_failure(file_, "the file holds no frames");
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
      for (const CsvCell& cell : cells_) table_.header.emplace_back(cell.text);
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
    for (const CsvCell& cell : cells_) table_.comment.emplace_back(cell.text);
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
        return fault(cell.column, "expected a number, found \"" + found + "\"",
                     found.find(',') == std::string::npos
                         ? ""
                         : "use a decimal point: numbers with commas are not read");
      }
      const bool first = &cell == &cells_.front();
      // written so that NaN is caught
      if (!(std::abs(*value) <= (first ? kMaxTime : kMaxNumber))) {
        return fault(cell.column, "the number " + found + " is out of range");
      }
      table_.values.push_back(*value);
    }
    table_.lines.push_back(line_);
    return {};
  }

  const std::string& file_;
  CsvTable table_;
  std::vector<CsvCell> cells_;
  std::size_t line_ = 0;  // from 1
  bool begun_ = false;    // a line with cells was read
};

}  // namespace

Result<CsvTable> read_csv_table(std::string_view text, const std::string& file) {
  return CsvTableReader(file).read(text);
}

}  // namespace retarget
