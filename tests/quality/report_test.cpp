#include "retarget/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "quality/measure.h"
#include "quality/walker.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_THAT(text, HasSubstr("still.csv  jump.csv"));
  EXPECT_THAT(text, HasSubstr("2 *"));
  EXPECT_THAT(text, HasSubstr("jump.csv: jumps is 2, wanted at most 0\n  right: 0.6 rad"));
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
