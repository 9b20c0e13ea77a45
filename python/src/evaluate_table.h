#pragma once

#include "retarget/option_table.h"
#include "retarget/options.h"

namespace retarget::python {

/// Returns the options of evaluate: limits, how to read the source, and whether to compute inverse
/// dynamics.
[[nodiscard]] OptionTable evaluate_table(Options& options, bool& dynamics);

}  // namespace retarget::python
