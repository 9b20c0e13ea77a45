#pragma once

#include "arguments.h"
#include "console.h"

namespace retarget::cli {

/// Makes a folder of pages of a batch's output folder: one for each clip, and one that lists them. The
/// index comes last, so that a gallery that was stopped has none, or the one that it had.
[[nodiscard]] Result<void> write_gallery(const ViewArguments& arguments, Console& console);

}  // namespace retarget::cli
