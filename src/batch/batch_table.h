#pragma once

#include "batch/run_batch.h"
#include "options/option_table.h"

namespace retarget {

/// The rows of a request but for what each clip's run has.
/// @param memory_gb  of all running clips together.
[[nodiscard]] OptionTable batch_table(BatchRequest& request, double& memory_gb);

/// Group of batches' options in help and docs.
inline constexpr const char* kBatchGroup = "Batch";

}  // namespace retarget
