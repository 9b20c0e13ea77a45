#pragma once

#include "arguments.h"
#include "console.h"

namespace retarget::cli {

/// Makes a folder of pages from a batch's output folder: one page per clip and an index. The index
/// is written last, so that an interrupted gallery has no new index.
[[nodiscard]] Result<void> write_gallery(const ViewArguments& arguments, Console& console);

}  // namespace retarget::cli
