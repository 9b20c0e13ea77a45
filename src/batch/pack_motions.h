#pragma once

#include <string>

#include "batch/run_batch.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "run/observer.h"

namespace retarget {

/// Checks the name of a packed file: one part, ending in .npz. Errors: of kUsage.
[[nodiscard]] Result<void> check_pack_name(const std::string& name);

/// Checks that the formats have one whose files can be packed. Errors: of kUsage.
[[nodiscard]] Result<void> check_pack_format(const SaveOptions& options);

/// Puts the tracking NPZ files of all clips that passed, as the manifest in a folder has it, into
/// one of the request's name, sorted by the names of the clips: arrays one after the other along time,
/// `clip_names`, `clip_starts` and `clip_lengths`. Of several robots each has its own, in its folder.
///
/// One clip's file is in memory at a time. Errors: files that are gone, changed, or unlike the first
/// one in rate, joints, bodies or arrays (kInput); kInterrupted.
[[nodiscard]] Result<void> pack_motions(const std::string& folder, const BatchRequest& request,
                                        Observer& observer);

}  // namespace retarget
