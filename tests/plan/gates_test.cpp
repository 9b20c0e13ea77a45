#include "retarget/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

Result<Gates> changed(const std::vector<std::string>& texts) {
  return changed_gates(texts, RETARGET_SOURCE_DIR);
}

std::optional<Gate> gate_on(const Gates& gates, const std::string& metric) {
  const auto found = std::ranges::find(gates.all(), metric, &Gate::metric);
  return found == gates.all().end() ? std::nullopt : std::optional(*found);
}

std::string error_of(const std::string& text) {
  const auto gates = changed({text});
  return gates ? "no error" : describe(gates.error());
}

TEST(ChangedGates, AreTheDefaultsWithoutChanges) {
  const Gates gates = default_gates(RETARGET_SOURCE_DIR).value();
  EXPECT_EQ(changed({}).value().all().size(), gates.all().size());
  EXPECT_EQ(changed({"default"}).value().all().size(), gates.all().size());
  EXPECT_TRUE(changed({"none"}).value().all().empty());
}

TEST(ChangedGates, BoundsReplaceTheGateOfTheirMetric) {
  const Gates gates = changed({"jumps<=3", "acc_p99=200", "flat_slip_p95>=0.5"}).value();
  EXPECT_EQ(gate_on(gates, "jumps")->max, 3.0);
  EXPECT_EQ(gate_on(gates, "acc_p99")->max, 200.0);
  EXPECT_EQ(gate_on(gates, "flat_slip_p95")->min, 0.5);
  EXPECT_FALSE(gate_on(gates, "flat_slip_p95")->max);
  EXPECT_FALSE(gate_on(changed({"jumps=none"}).value(), "jumps"));
}

TEST(ChangedGates, BothBoundsMakeOneGate) {
  const auto gate =
      gate_on(changed({"stance_height_p50_cm>=-1", "stance_height_p50_cm<=0.5"}).value(),
              "stance_height_p50_cm");
  EXPECT_EQ(gate->min, -1.0);
  EXPECT_EQ(gate->max, 0.5);
  // Bounds for any robot: as written.
  EXPECT_FALSE(gate->leg);
  // The first gate alone replaces the default gate.
  EXPECT_FALSE(
      gate_on(changed({"stance_height_p50_cm<=0.5"}).value(), "stance_height_p50_cm")->min);
}

TEST(ChangedGates, TheStricterOfTwoBoundsApplies) {
  for (const auto& texts : {std::vector<std::string>{"jumps<=1", "jumps<=3"},
                            {"jumps<=3", "jumps<=1"},
                            {"jumps=3", "jumps=1"},
                            {"jumps<=1", "jumps=3"}}) {
    EXPECT_EQ(gate_on(changed(texts).value(), "jumps")->max, 1.0) << texts.front();
  }
  const Gates gates = changed({"jumps>=-2", "jumps>=-1", "jumps=4", "jumps>=-3"}).value();
  EXPECT_EQ(gate_on(gates, "jumps")->min, -1.0);
  EXPECT_EQ(gate_on(gates, "jumps")->max, 4.0);
  EXPECT_FALSE(gate_on(changed({"jumps<=1", "jumps=none"}).value(), "jumps"));
}

TEST(ChangedGates, ShortNamesPreferMetricsWithAGate) {
  EXPECT_EQ(gate_on(changed({"limb_angle<=9"}).value(), "limb_angle_deg")->max, 9.0);
  EXPECT_EQ(gate_on(changed({"root_jerk<=9"}).value(), "root_jerk_mean")->max, 9.0);
  EXPECT_THAT(error_of("flat_slip<=1"), HasSubstr("is ambiguous: flat_slip_p50, flat_slip_p95"));
}

TEST(ChangedGates, FilesApplyInOrder) {
  TemporaryFolder folder;
  const std::string file = folder.write("own.json", R"({"gates": {"jumps": 7}})");
  EXPECT_EQ(gate_on(changed({"jumps<=1", file}).value(), "jumps")->max, 7.0);
  EXPECT_EQ(gate_on(changed({file, "jumps<=1"}).value(), "jumps")->max, 1.0);
}

TEST(ChangedGates, ErrorsSuggestSimilarNames) {
  EXPECT_THAT(error_of("jmps<=0"), HasSubstr("did you mean \"jumps\"?"));
  EXPECT_THAT(error_of("jumps<=few"), HasSubstr("\"few\""));
  EXPECT_THAT(error_of("jumps<=none"), HasSubstr("\"none\""));
  EXPECT_THAT(error_of("jumps<3"), HasSubstr("invalid relation \"<\""));
  EXPECT_THAT(error_of("jumps"), HasSubstr("needs a bound"));
  EXPECT_THAT(error_of("missing.json"), HasSubstr("missing.json"));
}

}  // namespace
}  // namespace retarget
