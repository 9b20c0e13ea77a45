#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "judge/quality/metric_group.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/report.h"
#include "support/value_of.h"

namespace retarget {
namespace {

TEST(Metrics, KeysAreUniqueAndFound) {
  for (const Metric& metric : quality_metrics()) {
    EXPECT_EQ(find_metric(metric.key), &metric);
    EXPECT_FALSE(metric.unit.empty() || metric.definition.empty() || metric.source.empty());
  }
  EXPECT_EQ(find_metric("no_metric"), nullptr);
}

TEST(Metrics, BelongToGroups) {
  const auto group = [](std::string_view key) { return group_of(*find_metric(key)); };
  EXPECT_EQ(group("limit_pct"), MetricGroup::kLimits);
  EXPECT_EQ(group("root_jumps"), MetricGroup::kSmoothness);
  EXPECT_EQ(group("foot_pen_1cm_pct"), MetricGroup::kFloor);
  EXPECT_EQ(group("float_planted_pct"), MetricGroup::kFloor);
  EXPECT_EQ(group("flat_slip_p95"), MetricGroup::kFeet);
  EXPECT_EQ(group("stance_slip_mean"), MetricGroup::kFeet);
  EXPECT_EQ(group("self_all_max_cm"), MetricGroup::kCollisions);
  EXPECT_EQ(group("touch_gap_cm"), MetricGroup::kSimilarity);
  EXPECT_EQ(group("flight_torque_cm"), MetricGroup::kDynamics);
  // Every group has a metric that a report without gates shows.
  for (const MetricGroup each : kMetricGroups) {
    int headlines = 0;
    for (const Metric& metric : quality_metrics()) {
      headlines += group_of(metric) == each && is_headline(metric) ? 1 : 0;
    }
    EXPECT_GT(headlines, 0) << group_name(each);
  }
}

TEST(Metrics, DefinitionsMatchTheDocumentation) {
  const auto page = value_of(read_file(std::string(RETARGET_SOURCE_DIR) + "/docs/quality.md"));
  for (const Metric& metric : quality_metrics()) {
    std::string row = "| `";
    row.append(metric.key).append("` | ").append(metric.unit).append(" | ");
    row.append(metric.definition).append(" | ").append(metric.source).append(" |");
    EXPECT_NE(page.view().find(row), std::string_view::npos) << row;
  }
}

}  // namespace
}  // namespace retarget
