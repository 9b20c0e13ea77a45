#include "io/csv_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/csv_cells.h"

namespace retarget {
namespace {

// beyond this a number is no motion of a robot in any unit
constexpr double kLargest = 1e6;

std::string columns_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " column" : " columns");
}

}  // namespace

Result<CsvTable> read_csv_table(std::string_view text, const std::string& file) {
  CsvTable table;
  std::vector<CsvCell> cells;
  std::size_t line_number = 0;
  bool begun = false;
  const auto fault = [&](std::size_t column, std::string message) {
    return failure({.kind = ErrorKind::kInput,
                    .file = file,
                    .line = line_number,
                    .column = column + 1,
                    .message = std::move(message),
                    .hint = {}});
  };
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    ++line_number;
    split_cells(text.substr(0, end), cells);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (cells.empty() || cells.front().text.starts_with('#')) continue;
    if (!std::exchange(begun, true) && !number_of_cell(cells.front().text)) {
      for (const CsvCell& cell : cells) table.header.emplace_back(cell.text);
      continue;
    }
    if (table.rows() == 0) table.columns = cells.size();
    if (cells.size() != table.columns) {
      return fault(0, "this line has " + columns_text(cells.size()) + ", those before it " +
                          std::to_string(table.columns));
    }
    for (const CsvCell& cell : cells) {
      const auto value = number_of_cell(cell.text);
      const std::string found(cell.text.substr(0, 40));
      if (!value) return fault(cell.column, "expected a number, found \"" + found + "\"");
      // written so that NaN is caught
      if (!(std::abs(*value) <= kLargest)) {
        return fault(cell.column, "the number " + found + " is out of range");
      }
      table.values.push_back(*value);
    }
    table.lines.push_back(line_number);
  }
  if (table.rows() == 0) return input_failure(file, "the file holds no frames");
  if (!table.header.empty() && table.header.size() != table.columns) {
    return input_failure(file, "the header has " + columns_text(table.header.size()) +
                                   ", the lines " + std::to_string(table.columns));
  }
  return table;
}

}  // namespace retarget
