#pragma once

#include <span>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/report.h"

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

}  // namespace retarget
