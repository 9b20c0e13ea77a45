#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/options.h"
#include "run/observer.h"

namespace retarget {

/// Checks that the formats have one whose files trainers take from a list. Errors: of kUsage.
[[nodiscard]] Result<void> check_motion_list(const SaveOptions& options);

/// Writes `motions.yaml` for what the manifest in a folder says is done, the list that TWIST2, GMT,
/// MimicKit and ProtoMotions train from: `root_path`, and `motions` with `file`, `weight` 1 and
/// `description` each. Of several robots each has its own, in its folder.
[[nodiscard]] Result<void> write_motion_lists(const std::string& folder, Observer& observer);

}  // namespace retarget
