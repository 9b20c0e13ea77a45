#pragma once

#include <list>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "retarget/batch.h"
#include "retarget/error.h"

namespace retarget {

/// Checks that all output files are distinct, that none has the path of an output folder, and that
/// none has the name of a file of the batch itself. Errors: kUsage.
[[nodiscard]] Result<void> check_outputs_of(const std::vector<BatchInput>& inputs,
                                            const BatchRequest& request);

/// Checks that no existing file that would be overwritten is also read, for example through a link
/// into the clips' folder. Errors: kUsage.
/// @param output  folder of the batch without a trailing slash.
[[nodiscard]] Result<void> check_outputs_spared(const std::vector<BatchInput>& inputs,
                                                const BatchRequest& request,
                                                const std::string& output,
                                                const std::list<BatchRobot>& robots);

}  // namespace retarget
