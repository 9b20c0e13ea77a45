#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/report.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

TEST(GatesTest, ReadsReplacesAndRemovesGates) {
  Gates gates;
  ASSERT_TRUE(gates.add_json(
      R"({"gates": {"jumps": 0, "limit_pct": {"max": 1}, "contact_height_p50_cm": {"min": -1, "max": 1}}})",
      "g.json"));
  ASSERT_TRUE(gates.add_json(R"({"gates": {"jumps": 5, "limit_pct": null}})", "h.json"));
  ASSERT_EQ(gates.all().size(), 2u);
  EXPECT_EQ(gates.all()[0].metric, "contact_height_p50_cm");
  EXPECT_EQ(gates.all()[0].min, -1.0);
  EXPECT_EQ(gates.all()[1].metric, "jumps");
  EXPECT_EQ(gates.all()[1].max, 5.0);
}

TEST(GatesTest, BoundsAreInclusive) {
  Gates gates;
  gates.set({"jumps", std::nullopt, 2.0});
  gates.set({"contact_height_p50_cm", -0.1, 0.1});
  QualityReport report;
  report.values = {{find_metric("jumps"), 2.0, std::nullopt}};
  gates.judge(report);
  ASSERT_EQ(report.gates.size(), 2u);
  EXPECT_TRUE(report.passed());  // Figures without a value miss no gate.
  report.values = {{find_metric("jumps"), 3.0, std::nullopt},
                   {find_metric("contact_height_p50_cm"), -0.2, std::nullopt}};
  gates.judge(report);
  EXPECT_FALSE(report.gates[0].passed);
  EXPECT_FALSE(report.gates[1].passed);
}

TEST(GatesTest, NamedGateMissesIfItsMetricIsNotMeasured) {
  Gates gates;
  gates.set({"limb_angle_deg", std::nullopt, 5.0, std::nullopt, true});
  gates.set({"scene_pen_1cm_pct", std::nullopt, 0.3, std::nullopt, true});
  gates.set({"jumps", std::nullopt, 0.0});
  QualityReport report;
  gates.judge(report);
  ASSERT_EQ(report.gates.size(), 3u);
  for (const GateResult& gate : report.gates) {
    EXPECT_FALSE(gate.value) << gate.metric;
    // The scene's metric is conditional.
    EXPECT_EQ(gate.passed, gate.metric != "limb_angle_deg") << gate.metric;
  }
  EXPECT_FALSE(report.passed());
}

TEST(GatesTest, StancesMissTheirGatesIfTheyWereLost) {
  Gates gates;
  gates.set({"stance_slip_mean", std::nullopt, 0.002});
  gates.set({"limb_angle_deg", std::nullopt, 15.0});
  QualityReport report;
  gates.judge(report);
  EXPECT_TRUE(report.passed());
  report.lost_stances = true;
  gates.judge(report);
  EXPECT_FALSE(report.passed());
  EXPECT_TRUE(report.gates.back().passed);
}

TEST(GatesTest, GateOnInverseDynamicsNeedsThem) {
  Gates gates;
  gates.set({"com_acc_p99", std::nullopt, 20.0});
  EXPECT_FALSE(gates.need_dynamics());
  gates.set({"torque_over_pct", std::nullopt, 0.0});
  EXPECT_TRUE(gates.need_dynamics());
}

TEST(GatesTest, BoundsScaleWithLegLength) {
  Gates gates;
  ASSERT_TRUE(gates.add_json(
      R"({"gates": {"stance_slip_mean": {"max": 0.002, "leg_m": 0.6}, "jumps": 2,
                    "stance_height_p50_cm": {"min": -0.3, "max": 0.3, "leg_m": 0.6}}})",
      "g.json"));
  QualityReport report;
  report.values = {{find_metric("jumps"), 2.0, std::nullopt},
                   {find_metric("stance_slip_mean"), 0.0015, std::nullopt},
                   {find_metric("stance_height_p50_cm"), -0.2, std::nullopt}};
  const auto bounds = [&](std::optional<double> leg) {
    report.leg = leg;
    gates.judge(report);
    std::vector<std::optional<double>> found;
    for (const GateResult& gate : report.gates) {
      found.push_back(gate.min);
      found.push_back(gate.max);
    }
    return found;
  };
  using Bounds = std::vector<std::optional<double>>;
  EXPECT_EQ(bounds(0.6), Bounds({std::nullopt, 2.0, std::nullopt, 0.002, -0.3, 0.3}));
  EXPECT_TRUE(report.passed());
  // Legs half as long: half the slip and height.
  EXPECT_EQ(bounds(0.3), Bounds({std::nullopt, 2.0, std::nullopt, 0.001, -0.15, 0.15}));
  EXPECT_TRUE(report.gates[0].passed);
  EXPECT_FALSE(report.gates[1].passed);
  EXPECT_FALSE(report.gates[2].passed);
  // Without a measured leg length, the bounds are as written.
  EXPECT_EQ(bounds(std::nullopt), Bounds({std::nullopt, 2.0, std::nullopt, 0.002, -0.3, 0.3}));
}

// Every motion is judged by every gate.
TEST(GatesTest, RejectsExceptions) {
  Gates gates;
  const auto done =
      gates.add_json(R"({"gates": {"jumps": {"max": 1, "unless": {"lying_pct": 10}}}})", "g.json");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(describe(done.error()), HasSubstr("the gate on jumps must be"));
  EXPECT_TRUE(gates.all().empty());
}

TEST(GatesTest, RejectsInvalidLegLength) {
  Gates gates;
  for (const char* gate :
       {R"({"max": 1, "leg_m": 0})", R"({"max": 1, "leg_m": "long"})", R"({"leg_m": 0.6})"}) {
    const auto done =
        gates.add_json(std::string(R"({"gates": {"jumps": )") + gate + "}}", "g.json");
    EXPECT_FALSE(done) << gate;
  }
  EXPECT_TRUE(gates.all().empty());
}

TEST(GatesTest, ReportsAllErrorsTogether) {
  Gates gates;
  const auto done = gates.add_json(
      R"({"gates": {"jmps": 0, "acc_p99": "low", "limit_pct": {"most": 1}, "self_max_cm": {}}})",
      "g.json");
  ASSERT_FALSE(done);
  const std::string text = describe(done.error());
  EXPECT_THAT(text, HasSubstr("4 errors in the gates"));
  EXPECT_THAT(text, HasSubstr("did you mean \"jumps\"?"));
  EXPECT_EQ(done.error().kind, ErrorKind::kConfig);
  EXPECT_TRUE(gates.all().empty());
  EXPECT_FALSE(gates.add_json("{}", "g.json"));
  EXPECT_FALSE(gates.add_json("[", "g.json"));
}

TEST(GatesTest, DefaultFileIsValid) {
  Gates gates;
  const auto done =
      gates.add_file(std::string(RETARGET_SOURCE_DIR) + "/configs/quality/default.json");
  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_GT(gates.all().size(), 5u);
}

}  // namespace
}  // namespace retarget
