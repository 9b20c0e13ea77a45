#include "batch/batch_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "retarget/report.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

ManifestEntry clip_with(const std::string& name, std::vector<std::string> missed, double ratio) {
  ManifestEntry entry;
  entry.relative = name;
  entry.robot = "g1";
  entry.done = true;
  entry.frames = 31;
  entry.fps = 30.0;
  const std::string worst = missed.empty() ? "" : missed.front();
  entry.quality = ClipQuality{{{"jumps", 2.0}}, std::move(missed), worst, ratio};
  return entry;
}

std::vector<std::string> second_cells(const std::string& text) {
  std::vector<std::string> cells;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(comma + 1, line.find(',', comma + 1) - comma - 1));
  }
  return cells;
}

TEST(Summary, ListsWorstClipsFirst) {
  ManifestEntry failed = clip_with("z.bvh", {}, 0.0);
  failed.done = false;
  failed.quality.reset();
  failed.error = Error{ErrorKind::kInput, {"in/z.bvh", 3, 4}, "no, \"this\"", {}, "that"};
  std::vector<ManifestEntry> entries = {clip_with("good.bvh", {}, 0.0),
                                        clip_with("b.bvh", {"jumps"}, 2.0),
                                        clip_with("a.bvh", {"jumps"}, 2.0),
                                        clip_with("two.bvh", {"jumps", "x"}, 1.5),
                                        clip_with("far.bvh", {"jumps"}, HUGE_VAL),
                                        failed};
  const std::string text = summary_csv(entries);
  EXPECT_THAT(second_cells(text),
              ElementsAre("z.bvh", "two.bvh", "far.bvh", "a.bvh", "b.bvh", "good.bvh"));
  EXPECT_THAT(text, HasSubstr("\"in/z.bvh:3:4: error: no, \"\"this\"\"\",that\n"));
  EXPECT_THAT(text, HasSubstr("\ndone,far.bvh,g1,31,30,1,1,jumps,inf,"));
  std::ranges::reverse(entries);
  EXPECT_EQ(summary_csv(entries), text);
}

TEST(Summary, HeaderListsEveryMetric) {
  const std::string text = summary_csv({});
  EXPECT_THAT(text, StartsWith("status,clip,robot,"));
  for (const Metric& metric : quality_metrics()) {
    EXPECT_THAT(text, HasSubstr("," + std::string(metric.key) + ","));
  }
}

TEST(ClipQualityOf, ListsMissedGatesAndTheWorst) {
  QualityReport report;
  report.values = {{find_metric("jumps"), 3.0, {}}, {find_metric("self_1cm_pct"), 4.0, {}}};
  report.gates = {{"self_1cm_pct", {}, 1.0, 4.0, false},
                  {"contact_height_p50_cm", -0.1, 0.1, -0.5, false},
                  {"fast_3pi_pct", {}, 0.2, 0.1, true}};
  const ClipQuality quality = clip_quality(report);
  EXPECT_THAT(quality.missed, ElementsAre("self_1cm_pct", "contact_height_p50_cm"));
  EXPECT_EQ(quality.worst, "contact_height_p50_cm");
  EXPECT_NEAR(quality.worst_ratio, 5.0, 1e-12);
  EXPECT_EQ(quality.figures.at(0).first, "jumps");
  report.gates.push_back({"jumps", {}, 0.0, 3.0, false});
  EXPECT_EQ(clip_quality(report).worst, "jumps");
  EXPECT_EQ(clip_quality(report).worst_ratio, HUGE_VAL);
}

TEST(ClipQualityOf, ExcessGrowsWithTheDistanceFromTheBound) {
  const auto ratio = [](std::optional<double> min, std::optional<double> max, double value) {
    QualityReport report;
    report.gates = {{"jumps", min, max, value, false}};
    return clip_quality(report).worst_ratio;
  };
  EXPECT_DOUBLE_EQ(ratio(10.0, {}, 8.0), 1.25);
  EXPECT_DOUBLE_EQ(ratio(10.0, {}, 0.5), 20.0);
  EXPECT_EQ(ratio(10.0, {}, 0.0), HUGE_VAL);
  EXPECT_EQ(ratio(10.0, {}, -1.0), HUGE_VAL);
  EXPECT_DOUBLE_EQ(ratio(-2.0, {}, -5.0), 2.5);
  EXPECT_DOUBLE_EQ(ratio({}, 2.0, 5.0), 2.5);
  EXPECT_DOUBLE_EQ(ratio({}, -2.0, -0.5), 4.0);
  EXPECT_EQ(ratio({}, -2.0, 0.5), HUGE_VAL);
  EXPECT_EQ(ratio({}, 1.0, std::nan("")), HUGE_VAL);
}

TEST(Summary, CellsAreNotFormulas) {
  for (const char* name :
       {"=cmd|' /C calc'!A0.bvh", "+1.bvh", "-1.bvh", "@SUM(A1).bvh", "\t=1.bvh"}) {
    ManifestEntry entry;
    entry.relative = name;
    entry.robot = "=robot";
    entry.error.emplace().message = "=message";
    entry.error->hint = "-hint";
    const std::string text = summary_csv({&entry, 1});
    const std::string row = text.substr(text.find('\n') + 1);
    EXPECT_TRUE(row.starts_with(std::string("failed,'") + name + ",'=robot,,")) << row;
    EXPECT_NE(row.find(",'-hint\n"), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace retarget
