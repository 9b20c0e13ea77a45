#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "bvh/source_text.h"
#include "retarget/error.h"

namespace retarget {

struct MotionRowsOptions {
  std::size_t row_width = 0;       ///< Values of a row, at least 1.
  std::int64_t declared_rows = 0;  ///< What `Frames:` says.
  std::size_t declared_place = 0;  ///< Byte offset of that number.
  bool lenient = false;            ///< Keep the complete rows of a damaged file.
};

struct MotionRows {
  int count = 0;
  int dropped = 0;  ///< Lines left out (lenient).
  std::vector<Warning> warnings;
};

/// Takes row `index`; a later call with the same index replaces it.
using RowSink = std::function<void(int index, std::span<const double> row)>;

/// Reads the motion rows from the scanner's place to the end of the text. Rows that a damage
/// made doubtful may have been given to the sink; those below `count` are good.
/// @pre the rest of the text is too short for more rows than an int counts.
[[nodiscard]] Result<MotionRows> parse_motion_rows(const SourceText& source, Scanner& scanner,
                                                   const MotionRowsOptions& options,
                                                   const RowSink& sink);

}  // namespace retarget
