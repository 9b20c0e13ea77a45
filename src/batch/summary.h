#pragma once

#include <span>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/report.h"

namespace retarget {

/// What a manifest keeps of a report.
[[nodiscard]] ClipQuality clip_quality(const QualityReport& report);

/// Failed clips lead, then most gates missed, then furthest beyond one, then by name.
[[nodiscard]] std::vector<const ManifestEntry*> worst_first(std::span<const ManifestEntry> entries);

/// A table for people and scripts, CSV with a header: a row per clip and robot, the worst first.
/// The columns are status, clip, robot, frames, fps, duration_s, gates_missed, worst, worst_ratio, every metric
/// by its key, message and hint. The same entries give the same bytes whatever their order.
[[nodiscard]] std::string summary_csv(std::span<const ManifestEntry> entries);

}  // namespace retarget
