#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/bvh/source_text.h"
#include "retarget/error.h"

namespace retarget {

struct MotionRowsOptions {
  std::size_t row_width = 0;       ///< Values per row, at least 1.
  std::int64_t declared_rows = 0;  ///< Value of `Frames:`.
  std::size_t declared_place = 0;  ///< Byte offset of that number.
  bool lenient = false;            ///< Keep the complete rows of a damaged file.
};

struct MotionRows {
  int count = 0;
  int dropped = 0;  ///< Dropped lines (lenient only).
  std::vector<Warning> warnings;
};

/// Receives row `index`; a later call with the same index replaces it.
using RowSink = std::function<void(int index, std::span<const double> row)>;

/// Parses motion rows from the scanner's position to the end of the text. The sink may also receive
/// rows that later prove damaged; only those below `count` are valid.
/// @pre the rest of the text is too short for more rows than an int can count.
[[nodiscard]] Result<MotionRows> parse_motion_rows(const SourceText& source, Scanner& scanner,
                                                   const MotionRowsOptions& options,
                                                   const RowSink& sink);

}  // namespace retarget
