#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "retarget/error.h"

namespace retarget {

/// A row of a table of clips.
struct ClipRow {
  std::string file;  ///< As the row names it.
  std::string part;  ///< ClipVariant::part.
  std::string name;  ///< Of the clip; empty: made of the file's.
  std::size_t line = 0;
};

/// Reads a table of clips: rows `file,start,end,name`, with a header or without; a header may have the
/// columns in another order and others besides. Ends are seconds (`12.3`) or frames (`f120`), or empty.
/// Errors (kInput) name file and line.
[[nodiscard]] Result<std::vector<ClipRow>> read_clip_table(const std::string& path);

/// The files that the rows name, below the table's folder: what is searched where nothing else is named.
[[nodiscard]] std::vector<std::string> files_of_rows(const std::vector<ClipRow>& rows,
                                                     const std::string& path);

/// The inputs that the rows make of those that were found: one for each row. A row's file is an input's
/// relative path, its path as it was found, or its name where one input alone is called so.
/// Errors (kInput) name the table and the line: a file that is not among the inputs, a name twice.
[[nodiscard]] Result<std::vector<BatchInput>> parts_of(const std::vector<BatchInput>& inputs,
                                                       const std::vector<ClipRow>& rows,
                                                       const std::string& path);

/// The inputs and, behind them, their mirror images.
[[nodiscard]] std::vector<BatchInput> with_mirror_images(std::vector<BatchInput> inputs);

}  // namespace retarget
