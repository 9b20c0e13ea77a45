#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The numbers of a CSV, without interpretation.
struct CsvTable {
  /// Cells of the first line, if it does not begin with a number.
  std::vector<std::string> header;
  /// Without a header: cells of the last comment before the numbers, if it has as many cells as a
  /// row (the header format of numpy.savetxt).
  std::vector<std::string> comment;
  std::size_t columns = 0;
  std::vector<double> values;      ///< Row-major.
  std::vector<std::size_t> lines;  ///< One-based line number of each row.
  /// The last line has no line ending, and its last number has fewer decimals than in all lines
  /// before it, as in a file that was not copied completely.
  bool may_be_cut_off = false;

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  [[nodiscard]] std::span<const double> row(std::size_t index) const {
    return std::span<const double>(values).subspan(index * columns, columns);
  }
};

/// Reads lines of numbers, with cells as split_cells separates them. Lines end with LF or CR LF; in
/// files without any LF, with CR. Skips empty lines and lines that begin with #.
/// Errors (kInput) with line and column: no lines, lines of different length, cells that are not
/// numbers, numbers beyond 1e6 (in the first column, which may be a time since 1970: beyond 1e20),
/// UTF-16.
[[nodiscard]] Result<CsvTable> read_csv_table(std::string_view text, const std::string& file);

/// A cell of a line without surrounding blanks and double quotes, and its zero-based start in the
/// line.
struct CsvCell {
  std::string_view text;
  std::size_t column = 0;
};

/// Splits a line into cells. The delimiter is detected per line: semicolons if there are any,
/// otherwise commas, otherwise runs of tabs, otherwise runs of spaces. Delimiters within double
/// quotes are ignored.
void split_cells(std::string_view line, std::vector<CsvCell>& cells);

}  // namespace retarget
