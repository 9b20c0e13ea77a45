#pragma once

#include <list>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "batch/run_batch.h"
#include "retarget/error.h"

namespace retarget {

/// No two files that a batch would write are one, none is where a folder is to be, and none is called
/// like a file of the batch itself; kUsage errors.
[[nodiscard]] Result<void> check_outputs_of(const std::vector<BatchInput>& inputs,
                                            const BatchRequest& request);

/// No file that is there already and would be written is one that is read: a link into the clips'
/// folder, say; kUsage errors.
/// @param output  the batch's folder, without a last slash.
[[nodiscard]] Result<void> check_outputs_spared(const std::vector<BatchInput>& inputs,
                                                const BatchRequest& request,
                                                const std::string& output,
                                                const std::list<BatchRobot>& robots);

}  // namespace retarget
