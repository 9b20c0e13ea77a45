#pragma once

#include "retarget/option_table.h"

namespace retarget::cli {

/// Returns the options of batch and live; empty with RETARGET_QUICK_START. Its rows refer to
/// arguments that no longer exist; use only their names and descriptions.
[[nodiscard]] OptionTable outer_option_table();

}  // namespace retarget::cli
