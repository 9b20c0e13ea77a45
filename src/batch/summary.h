#pragma once

#include <span>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/run.h"

namespace retarget {

/// The part of a report that a manifest keeps.
[[nodiscard]] ClipQuality clip_quality(const QualityReport& report);

/// Sorts entries: failed clips first, then by number of missed gates, by distance beyond a gate,
/// and by name.
[[nodiscard]] std::vector<const ManifestEntry*> worst_first(std::span<const ManifestEntry> entries);

/// A CSV table with a header and a row per clip and robot, the worst first. The columns are status,
/// clip, robot, frames, fps, duration_s, gates_missed, worst, worst_ratio, every metric by its key,
/// message and hint. The result does not depend on the order of the entries.
[[nodiscard]] std::string summary_csv(std::span<const ManifestEntry> entries);

/// Checks that at least one format can be listed for training frameworks. Errors: kUsage.
[[nodiscard]] Result<void> check_motion_list(const SaveOptions& options);

/// Writes `motions.yaml` for the finished clips of the manifest in a folder. This is the list
/// format of TWIST2, GMT, MimicKit and ProtoMotions: `root_path`, and `motions` with `file`,
/// `weight` 1 and `description` each. With several robots, each folder of a robot gets its own
/// list.
[[nodiscard]] Result<void> write_motion_lists(const std::string& folder, Observer& observer);

}  // namespace retarget
