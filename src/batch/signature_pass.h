#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/resume.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/plan.h"
#include "retarget/run.h"

namespace retarget {

/// Signature of the motion that a run solves, as bytes.
[[nodiscard]] std::string signature_of(const Plan& plan);

/// Computes the signature of every clip in separate processes. Each file is read and its human is
/// identified; nothing is solved. Recorded signatures are reused for unchanged files. A clip that
/// cannot be read gets no signature; its run reports the error later. Errors: kInterrupted.
/// @param inputs  their `signature` is set, except for mirror images.
[[nodiscard]] Result<void> find_signatures(std::vector<BatchInput>& inputs, const BatchRobot& robot,
                                           const BatchRequest& request,
                                           const FinishedClips& finished, Observer& observer);

/// Finds inputs that duplicate others, by `relative`. Includes the mirror images that the batch
/// creates of them. Errors: kInterrupted.
[[nodiscard]] Result<std::map<std::string, RepeatedClip>> repeated_inputs(
    const std::vector<BatchInput>& inputs, Observer& observer);

}  // namespace retarget
