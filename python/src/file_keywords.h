#pragma once

#include "retarget/option_table.h"
#include "retarget/run.h"

namespace retarget::python {

/// Returns the options of convert except the robot's name and the files.
[[nodiscard]] OptionTable convert_keywords(ConvertRequest& request);

}  // namespace retarget::python
