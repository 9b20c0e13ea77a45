#pragma once

#include "batch/run_batch.h"
#include "options/option_table.h"

namespace retarget::python {

/// All options of batch beside inputs, output and robots.
[[nodiscard]] OptionTable batch_keywords(BatchRequest& request);

}  // namespace retarget::python
