#pragma once

#include "retarget/measure_files.h"
#include "retarget/option_table.h"

namespace retarget::python {

/// Returns the options of certify except the files and the robot's name.
[[nodiscard]] OptionTable certify_keywords(MeasureRequest& request);

}  // namespace retarget::python
