#pragma once

#include "options/option_table.h"
#include "retarget/options.h"

namespace retarget::python {

/// The options of evaluate: limits, and how the source is read.
[[nodiscard]] OptionTable evaluate_table(Options& options);

}  // namespace retarget::python
