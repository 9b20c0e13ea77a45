#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace retarget {

/// A cell of a line and where it begins, from 0.
struct CsvCell {
  std::string_view text;
  std::size_t column = 0;
};

/// The cells of a line: a comma or semicolon with blanks around it, or blanks alone, part two.
void split_cells(std::string_view line, std::vector<CsvCell>& cells);

/// The number that a cell is, all of it.
[[nodiscard]] std::optional<double> number_of_cell(std::string_view text);

}  // namespace retarget
