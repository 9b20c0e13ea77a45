#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace retarget {

/// A cell of a line, without blanks and double quotes around it, and where it begins, from 0.
struct CsvCell {
  std::string_view text;
  std::size_t column = 0;
};

/// The cells of a line. What parts them is found in the line itself: semicolons where it has one,
/// else commas, else runs of tabs, else runs of blanks; never within double quotes.
void split_cells(std::string_view line, std::vector<CsvCell>& cells);

/// The number that a cell is, all of it.
[[nodiscard]] std::optional<double> number_of_cell(std::string_view text);

}  // namespace retarget
