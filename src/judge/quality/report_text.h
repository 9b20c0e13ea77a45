#pragma once

#include <span>
#include <vector>

#include "judge/quality/report_parts.h"

namespace retarget {

/// All metrics with a value in any report, by group, then in report order.
[[nodiscard]] std::vector<const Metric*> metrics_by_group(std::span<const QualityReport> reports);

/// A table with a header line, then one row per metric: its group, its name, its unit or its bound,
/// and one value per motion with the mark of its gate.
/// @param units  whether to show units instead of bounds, and also 95th percentiles.
[[nodiscard]] std::vector<ReportLine> metric_table(std::span<const QualityReport> reports,
                                                   std::span<const Metric* const> metrics,
                                                   bool units);

}  // namespace retarget
