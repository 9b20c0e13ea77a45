#include "view/page.h"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "retarget/report.h"

namespace retarget {
namespace {

TEST(MetricLabel, IsUniquePerMetric) {
  std::set<std::string_view> labels;
  for (const Metric& metric : quality_metrics()) {
    const std::string_view label = metric_label(metric.key);
    EXPECT_NE(label, metric.key);
    EXPECT_EQ(label.find('_'), std::string_view::npos) << label;
    EXPECT_TRUE(labels.insert(label).second) << label;
  }
  EXPECT_EQ(metric_label("unknown_pct"), "unknown_pct");
}

}  // namespace
}  // namespace retarget
