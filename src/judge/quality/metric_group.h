#pragma once

#include <array>
#include <string_view>

#include "retarget/report.h"

namespace retarget {

/// Topic of a metric; human-readable reports group metrics by topic.
enum class MetricGroup : unsigned char {
  kLimits,
  kSmoothness,
  kFeet,
  kFloor,
  kCollisions,
  kScene,
  kSimilarity,
  kDynamics,
};

/// All groups, in report order.
inline constexpr std::array kMetricGroups = {MetricGroup::kLimits,     MetricGroup::kSmoothness,
                                             MetricGroup::kFeet,       MetricGroup::kFloor,
                                             MetricGroup::kCollisions, MetricGroup::kScene,
                                             MetricGroup::kSimilarity, MetricGroup::kDynamics};

/// Name of a group: `limits`, `smoothness`, ...
[[nodiscard]] std::string_view group_name(MetricGroup group);

/// The group of a metric of quality_metrics().
[[nodiscard]] MetricGroup group_of(const Metric& metric);

/// Whether a short report also shows the metric without a gate.
[[nodiscard]] bool is_headline(const Metric& metric);

}  // namespace retarget
