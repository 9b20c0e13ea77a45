#pragma once

#include "retarget/option_table.h"
#include "retarget/options.h"

namespace retarget::python {

/// Returns all options of to_robot except the robot: human, part, solver, time and output.
[[nodiscard]] OptionTable solving_table(Options& options);

}  // namespace retarget::python
