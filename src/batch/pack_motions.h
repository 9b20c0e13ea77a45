#pragma once

#include <string>

#include "batch/manifests.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/run.h"

namespace retarget {

/// Checks the name of a packed file: one path component that ends in .npz. Errors: kUsage.
[[nodiscard]] Result<void> check_pack_name(const std::string& name);

/// Checks that at least one format can be packed. Errors: kUsage.
[[nodiscard]] Result<void> check_pack_format(const SaveOptions& options);

/// Packs the tracking NPZ files of all passed clips of the manifest in a folder into one file with
/// the request's name. Clips are sorted by name and concatenated along time; `clip_names`,
/// `clip_starts` and `clip_lengths` locate them. With several robots, each folder of a robot gets
/// its own file.
///
/// Only one clip is in memory at a time. Errors: files that are missing, changed, or differ from
/// the first one in rate, joints, bodies or arrays (kInput); a batch of other formats (kUsage);
/// kInterrupted.
/// @param selection  clips and robots to pack; null: all.
[[nodiscard]] Result<void> pack_motions(const std::string& folder, const BatchRequest& request,
                                        const BatchSelection* selection, Observer& observer);

}  // namespace retarget
