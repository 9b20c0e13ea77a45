#pragma once

#include <string>
#include <vector>

#include "retarget/measure_files.h"
#include "retarget/options.h"
#include "retarget/run.h"

namespace retarget {

using RecordedMotions = std::vector<RecordedMotion>;

[[nodiscard]] RecordedMotions recorded_motions(const std::vector<std::string>& files);

/// Sets the part of the source and its mirroring as the sidecars of motions record them, unless the
/// options give a part. Names recorded options that the comparison needs and that are not given.
/// @param run        its motion is the source.
/// @param of_source  receives the mirroring.
void choose_part(const RecordedMotions& motions, Run& run, RunRequest& of_source,
                 Observer& observer);

}  // namespace retarget
