#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// The numbers of a CSV, whatever they mean.
struct CsvTable {
  /// Cells of a first line that begins with no number.
  std::vector<std::string> header;
  /// Of a file without one: cells of the last comment before the numbers, where it has as many as
  /// they have (numpy.savetxt writes a header so).
  std::vector<std::string> comment;
  std::size_t columns = 0;
  std::vector<double> values;      ///< Row by row.
  std::vector<std::size_t> lines;  ///< Of each row in the file, from 1.

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  [[nodiscard]] std::span<const double> row(std::size_t index) const {
    return std::span<const double>(values).subspan(index * columns, columns);
  }
};

/// Reads lines of numbers: cells as split_cells parts them; empty lines and those that begin with #
/// are skipped.
/// Errors (kInput) with line and column: no lines, lines of different length, what is no number,
/// numbers beyond 1e6 (in a first column, which may be a time since 1970, beyond 1e20), UTF-16.
[[nodiscard]] Result<CsvTable> read_csv_table(std::string_view text, const std::string& file);

}  // namespace retarget
