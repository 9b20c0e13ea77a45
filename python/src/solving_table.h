#pragma once

#include "options/option_table.h"
#include "retarget/options.h"

namespace retarget::python {

/// All options of to_robot beside the robot: of the human, the part, the solution, time and output.
[[nodiscard]] OptionTable solving_table(Options& options);

}  // namespace retarget::python
