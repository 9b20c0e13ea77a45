#include "retarget/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "judge/quality/metric_group.h"
#include "quality/walker.h"
#include "retarget/measure.h"

namespace retarget {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

long lines_of(std::string_view text) {
  return std::ranges::count(text, '\n');
}

// Gates on the first metrics that are not headlines and on others, this many; every one is missed,
// with three faults each.
QualityReport report_of_gates(std::size_t count, bool missed) {
  QualityReport report;
  report.file = "walk.csv";
  report.robot = "unitree_g1";
  report.frames = 300;
  for (const Metric& metric : quality_metrics()) {
    report.values.push_back({&metric, 123.45, 234.5});
    if (report.gates.size() == count) continue;
    const std::string key(metric.key);
    report.gates.push_back({key, std::nullopt, missed ? 0.125 : 200.0, 123.45, !missed});
    for (int i = 0; i < 3; ++i) report.faults.push_back({key, "left_knee", 3, 7, 5, 0.5, "rad"});
  }
  return report;
}

TEST_F(MeasureQuality, JsonHasAllFiguresAndDefinitions) {
  const HumanClip human = standing_human(30);
  QualityReport report = measure(
      30, [](int, auto) {}, &human);
  report.file = "bad \xff name";
  const auto json = nlohmann::json::parse(report_json({&report, 1}));
  const auto& motion = json["motions"][0];
  EXPECT_EQ(motion["frames"], 30);
  for (const MetricValue& value : report.values) {
    const std::string key(value.metric->key);
    EXPECT_EQ(motion[key].get<double>(), value.value);
    EXPECT_TRUE(json["metrics"][key].contains("unit"));
  }
}

TEST_F(MeasureQuality, TextHasAColumnPerMotionAndMissedGates) {
  std::vector<QualityReport> reports;
  reports.push_back(measure(10, [](int, auto) {}));
  reports.push_back(measure(10, [](int frame, auto qpos) { qpos[kRight] = frame == 5 ? 0.6 : 0; }));
  reports[0].file = "still.csv";
  reports[1].file = "jump.csv";
  Gates gates;
  gates.set({"jumps", std::nullopt, 0.0});
  for (QualityReport& report : reports) gates.judge(report);
  const std::string text = report_text(reports);
  EXPECT_THAT(text,
              StartsWith("still.csv: 1 of 1 gate passed\njump.csv: 0 of 1 gate passed, 1 missed\n"
                         "jump.csv: jumps is 2, expected at most 0\n  right: 0.6 rad"));
  EXPECT_THAT(text, ContainsRegex("\n +metric +gate +still.csv +jump.csv\n"));
  EXPECT_THAT(text, ContainsRegex("\n +jumps +<=0 +0 [+] +2 x\n"));
  // Every metric has its row only on request.
  EXPECT_THAT(text, Not(HasSubstr("root_jerk_p99")));
  EXPECT_THAT(report_text(reports, {.all = true}), HasSubstr("root_jerk_p99"));
}

TEST(ReportText, OrdersVerdictMissedGatesAndGroups) {
  QualityReport report = report_of_gates(3, false);
  report.gates[1].passed = false;
  report.gates[1].max = 100.0;
  const std::string text = report_text({&report, 1});
  EXPECT_THAT(text, StartsWith("walk.csv: 2 of 3 gates passed, 1 missed (unitree_g1, 300 frames)\n"
                               "walk.csv: limit_pct is 123.5, expected at most 100\n"
                               "  left_knee: 0.5 rad, frames 3-6, worst 5\n"));
  EXPECT_THAT(text, HasSubstr("\nlimits      + solver_failures 123.5 <=200"));
  EXPECT_THAT(text, HasSubstr("x limit_pct 123.5 <=100"));
  // A metric without a gate has no mark.
  EXPECT_THAT(text, HasSubstr("\nsimilarity    limb_angle_deg 123.5 "));
  std::size_t last = 0;
  for (const MetricGroup group : kMetricGroups) {
    const std::size_t at = text.find("\n" + std::string(group_name(group)) + " ");
    ASSERT_NE(at, std::string::npos) << group_name(group);
    EXPECT_GT(at, last) << group_name(group);
    last = at;
  }
}

TEST(ReportText, HasAtMost25LinesOf80Columns) {
  for (const std::size_t count : {0U, 1U, 23U, 30U}) {
    for (const bool missed : {false, true}) {
      const QualityReport report = report_of_gates(count, missed);
      const std::string text = report_text({&report, 1});
      EXPECT_LE(lines_of(text), kReportLines) << text;
      for (const GateResult& gate : report.gates) {
        EXPECT_THAT(text, HasSubstr((missed ? "x " : "+ ") + gate.metric + " 123.5 "));
      }
      for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin);
        EXPECT_LE(end - begin, 80U) << text.substr(begin, end - begin);
        begin = end + 1;
      }
      const std::vector<QualityReport> three(3, report);
      EXPECT_LE(lines_of(report_text(three)), kReportLines) << report_text(three);
      EXPECT_GT(lines_of(report_text({&report, 1}, {.all = true})), 50);
    }
  }
  // For many motions, which have one line each, the table remains.
  const std::vector<QualityReport> forty(40, report_of_gates(30, true));
  EXPECT_THAT(report_text(forty), ContainsRegex("\n +limit_pct +<=0.125 +123.5 x"));
  EXPECT_LE(lines_of(report_text(forty)), 55);
  const QualityReport many = report_of_gates(30, true);
  EXPECT_THAT(report_text({&many, 1}), ContainsRegex("\nand [0-9]+ more\n"));
}

TEST(ReportText, UsesColoursOnlyOnRequestAndEscapesFileNames) {
  QualityReport report = report_of_gates(2, true);
  report.file = "a\033[31m.csv";
  EXPECT_THAT(report_text({&report, 1}), Not(HasSubstr("\033")));
  const std::string painted = report_text({&report, 1}, {.colour = true});
  EXPECT_THAT(painted, HasSubstr("\033[31mx\033[0m limit_pct"));
  EXPECT_THAT(painted, Not(HasSubstr("a\033")));
  report.gates[0].passed = true;
  EXPECT_THAT(report_text({&report, 1}, {.colour = true}),
              HasSubstr("\033[32m+\033[0m solver_failures"));
}

TEST(ReportText, ShowsEnoughDigitsForAMiss) {
  QualityReport report;
  report.file = "m.csv";
  report.values = {{find_metric("fast_3pi_pct"), 0.200001, std::nullopt}};
  Gates gates;
  gates.set({"fast_3pi_pct", std::nullopt, 0.2});
  gates.judge(report);
  EXPECT_THAT(report_text({&report, 1}),
              HasSubstr("fast_3pi_pct is 0.200001, expected at most 0.2\n"));
}

TEST_F(MeasureQuality, TextShowsBothLeansIfTheirGateIsMissed) {
  QualityReport report;
  report.values = {{find_metric("trunk_lean_error_deg"), 22.0, 30.0}};
  report.trunk_lean = TrunkLean{.human = 25.5, .robot = 3.5};
  Gates gates;
  gates.set({"trunk_lean_error_deg", std::nullopt, 25.0});
  gates.judge(report);
  EXPECT_THAT(report_text({&report, 1}), Not(HasSubstr("leans")));
  gates.set({"trunk_lean_error_deg", std::nullopt, 10.0});
  gates.judge(report);
  EXPECT_THAT(report_text({&report, 1}),
              HasSubstr("on average the robot leans by 3.5 degrees, the human by 25.5"));
}

}  // namespace
}  // namespace retarget
