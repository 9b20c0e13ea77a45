#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/run.h"

namespace retarget {

/// Checks that at least one format can be listed for trainers. Errors: kUsage.
[[nodiscard]] Result<void> check_motion_list(const SaveOptions& options);

/// Writes `motions.yaml` for the finished clips of the manifest in a folder. This is the list
/// format of TWIST2, GMT, MimicKit and ProtoMotions: `root_path`, and `motions` with `file`,
/// `weight` 1 and `description` each. With several robots, each folder of a robot gets its own
/// list.
[[nodiscard]] Result<void> write_motion_lists(const std::string& folder, Observer& observer);

}  // namespace retarget
