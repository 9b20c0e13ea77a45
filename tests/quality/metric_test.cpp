#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "base/file.h"
#include "retarget/error.h"
#include "retarget/report.h"

namespace retarget {
namespace {

TEST(Metrics, KeysAreUniqueAndFound) {
  for (const Metric& metric : quality_metrics()) {
    EXPECT_EQ(find_metric(metric.key), &metric);
    EXPECT_FALSE(metric.unit.empty() || metric.definition.empty() || metric.source.empty());
  }
  EXPECT_EQ(find_metric("no_metric"), nullptr);
}

TEST(Metrics, DefinitionsMatchTheDocumentation) {
  const auto page = read_file(std::string(RETARGET_SOURCE_DIR) + "/docs/quality.md");
  ASSERT_TRUE(page) << describe(page.error());
  for (const Metric& metric : quality_metrics()) {
    std::string row = "| `";
    row.append(metric.key).append("` | ").append(metric.unit).append(" | ");
    row.append(metric.definition).append(" | ").append(metric.source).append(" |");
    EXPECT_NE(page->view().find(row), std::string_view::npos) << row;
  }
}

}  // namespace
}  // namespace retarget
