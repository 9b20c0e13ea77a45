#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/resume.h"
#include "batch/run_batch.h"
#include "retarget/error.h"
#include "run/observer.h"

namespace retarget {

/// Finds the signature of every clip, in processes of its own as the clips are done: reads each file,
/// finds the human in it, and solves nothing. Signatures of earlier runs serve where the file is as it
/// was. A clip that cannot be read gets none: its run will say why. Errors: kInterrupted.
/// @param inputs  whose `signature` is set; mirror images have none.
[[nodiscard]] Result<void> find_signatures(std::vector<BatchInput>& inputs, const BatchRobot& robot,
                                           const BatchRequest& request,
                                           const FinishedClips& finished, Observer& observer);

/// Which inputs repeat others among them, by `relative`; their mirror images that the batch makes are
/// among them. Errors: kInterrupted.
[[nodiscard]] Result<std::map<std::string, RepeatedClip>> repeated_inputs(
    const std::vector<BatchInput>& inputs, Observer& observer);

}  // namespace retarget
