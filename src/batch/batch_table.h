#pragma once

#include "batch/run_batch.h"
#include "retarget/option_table.h"

namespace retarget {

/// The rows of a batch request, without the rows of each clip's run.
/// @param run  settings of every clip. Its memory limit applies to all running clips together. The
///             row `base` sets its robot's base and still accepts a folder, its former meaning.
[[nodiscard]] OptionTable batch_table(BatchRequest& request, Run& run);

/// Group of batch options in help and docs.
inline constexpr const char* kBatchGroup = "Batch";

}  // namespace retarget
