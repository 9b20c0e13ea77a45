#pragma once

#include "options/option_table.h"
#include "retarget/options.h"

namespace retarget::python {

/// The options of evaluate: limits, how the source is read, and whether inverse dynamics are
/// measured.
[[nodiscard]] OptionTable evaluate_table(Options& options, bool& dynamics);

}  // namespace retarget::python
