#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// A row of a clip table.
struct ClipRow {
  std::string file;  ///< File name as written in the row.
  std::string part;  ///< ClipVariant::part.
  std::string name;  ///< Clip name; empty: derived from the file name.
  std::size_t line = 0;
};

/// Reads a clip table with rows `file,start,end,name` and an optional header. With a header,
/// columns may be in any order and further columns are ignored. Start and end are seconds (`12.3`)
/// or frames (`f120`), or empty. Errors (kInput) name file and line.
[[nodiscard]] Result<std::vector<ClipRow>> read_clip_table(const std::string& path);

/// The files named in the rows, relative to the table's folder: the inputs if no others are given.
/// A missing file is an error that names its line.
[[nodiscard]] Result<std::vector<std::string>> files_of_rows(const std::vector<ClipRow>& rows,
                                                             const std::string& path);

/// Creates one input per row from the inputs that were found. A row's file is the relative path of
/// an input, its path as found, or its file name if that is unique.
/// Errors (kInput) name the table and the line: a file that is not among the inputs, a duplicate
/// name.
[[nodiscard]] Result<std::vector<BatchInput>> parts_of(const std::vector<BatchInput>& inputs,
                                                       const std::vector<ClipRow>& rows,
                                                       const std::string& path);

/// Returns the inputs, followed by their mirror images.
[[nodiscard]] std::vector<BatchInput> with_mirror_images(std::vector<BatchInput> inputs);

/// Returns the inputs, followed by `count` variations of each, in which the scene is changed at
/// random: the sizes of SolveOptions::terrain if it is set; otherwise position and size of the
/// objects, if they have tracks; otherwise the heights of the scene. The changes depend only on the
/// seed, the clip's name and the number of the variation.
/// Errors (kUsage): the options have no scene.
[[nodiscard]] Result<std::vector<BatchInput>> with_variations(std::vector<BatchInput> inputs,
                                                              int count, int seed,
                                                              const SolveOptions& options);

/// Applies ClipVariant::changes to options. Unknown changes are ignored.
void apply_changes(const std::string& changes, SolveOptions& options);

}  // namespace retarget
