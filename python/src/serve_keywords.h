#pragma once

#include "retarget/option_table.h"
#include "retarget/serve_table.h"

namespace retarget::python {

/// Returns the options of serve except the robot and the rate.
[[nodiscard]] OptionTable serve_keywords(ServeRequest& request);

}  // namespace retarget::python
