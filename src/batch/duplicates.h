#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/find_inputs.h"
#include "batch/motion_signature.h"
#include "batch/resume.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/plan.h"
#include "retarget/repeated_clips.h"
#include "retarget/run.h"

namespace retarget {

/// Marks a clip as a duplicate of an earlier one.
struct DuplicateOf {
  std::size_t index = 0;  ///< Index of the earlier clip.
  bool mirrored = false;  ///< Whether it is the mirror image.
  double distance = 0.0;  ///< signature_distance(), degrees.
};

/// Maximum distance between duplicates, degrees.
inline constexpr double kDuplicateDistance = 2.5;

/// For each clip, finds an earlier clip that it duplicates and that is not a duplicate itself.
/// Instead of comparing all pairs, a k-d tree finds candidates with similar means, and the nearest
/// of them are compared.
/// @param clips       clips in order of preference; null or empty clips are never duplicates.
/// @param keep_going  polled regularly; when it returns false, the remaining clips are skipped.
/// @param limit       maximum distance of a duplicate, degrees.
/// @param chains      also finds earlier clips that are duplicates, so that results form chains.
[[nodiscard]] std::vector<std::optional<DuplicateOf>> find_duplicates(
    const std::vector<const MotionSignature*>& clips, const std::function<bool()>& keep_going = {},
    double limit = kDuplicateDistance, bool chains = false);

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
