#pragma once

#include "retarget/batch.h"
#include "retarget/option_table.h"

namespace retarget::python {

/// Returns all options of batch except inputs, output and robots.
[[nodiscard]] OptionTable batch_keywords(BatchRequest& request);

}  // namespace retarget::python
