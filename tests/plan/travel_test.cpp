// Scaled travel and the preset for policies: plans, motions and their reports.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "retarget/file.h"
#include "retarget/option_table.h"
#include "retarget/retarget.h"
#include "support/accelerated.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::HasSubstr;

const std::string kRepository = RETARGET_SOURCE_DIR;

Clip clip_at_rate(const std::string& name, double fps = 0.0) {
  SourceOptions options;
  options.source_fps = fps;
  return load_clip(kRepository + "/data/" + name + ".bvh", options).value();
}

LoadedRobot robot_named(const std::string& name) {
  RobotChoice choice;
  choice.name = name;
  return load_robot(choice, {kRepository}).value();
}

const LoadedRobot& loaded_g1() {
  static const LoadedRobot robot = robot_named("unitree_g1");
  return robot;
}

Options with_travel(const std::string& travel) {
  Options options;
  options.solve.travel = travel;
  return options;
}

Options for_tracking() {
  Options options;
  options.solve.purpose = Purpose::kTracking;
  return options;
}

// One second.
Options short_part(Options options) {
  options.part.frames = "60:90";
  return options;
}

Motion solved(Clip clip, const Options& options, int threads = 1) {
  auto plan = make_plan(std::move(clip), loaded_g1(), options);
  SolveControl control;
  control.threads = threads;
  auto motion = solve(std::move(plan).value(), control);
  return std::move(motion).value();
}

std::string csv_of(const Clip& clip, const Options& options) {
  return format_robot_csv(solved(clip, options).clip);
}

double way(const RobotClip& clip) {
  const auto first = clip.qpos(0), last = clip.qpos(clip.frame_count() - 1);
  return std::hypot(last[0] - first[0], last[1] - first[1]);
}

double travel_of(const Clip& clip, const LoadedRobot& robot) {
  return make_plan(clip, robot, with_travel("auto")).value().travel->factor;
}

FitOptions fit_of(const Options& options) {
  return set_up_robot(loaded_g1(), options).value().fit;
}

std::string missed(const QualityReport& report) {
  std::string text;
  for (const GateResult& gate : report.gates) {
    if (!gate.passed) text += gate.metric + " ";
  }
  return text;
}

TEST(TravelOfMotions, ScalesTheDistanceAndKeepsTheGates) {
  const Motion whole = solved(clip_at_rate("walk"), {}),
               shorter = solved(clip_at_rate("walk"), with_travel("0.9"));
  ASSERT_GT(way(whole.clip), 2.0);
  EXPECT_NEAR(way(shorter.clip) / way(whole.clip), 0.9, 0.005);
  const QualityReport report = evaluate(shorter).value();
  EXPECT_EQ(missed(report), "");
  ASSERT_TRUE(report.travel);
  EXPECT_DOUBLE_EQ(report.travel->factor, 0.9);
  for (const char* metric : {"stance_slip_mean", "stance_drift_p95_cm", "stance_height_p50_cm",
                             "root_slide_mean", "lag_s"}) {
    EXPECT_NE(report.find(metric), nullptr) << metric;
  }
  // The mean height of the root does not change.
  const auto mean_height = [](const RobotClip& clip) {
    double sum = 0.0;
    for (int frame = 0; frame < clip.frame_count(); ++frame) sum += clip.qpos(frame)[2];
    return sum / clip.frame_count();
  };
  EXPECT_NEAR(mean_height(shorter.clip), mean_height(whole.clip), 0.01);
}

TEST(TravelOfMotions, AutoDoesNotChangeASlowClip) {
  const Clip clip = clip_at_rate("turn_in_place");
  const Options automatic = short_part(with_travel("auto"));
  const Motion motion = solved(clip, automatic);
  EXPECT_EQ(format_robot_csv(motion.clip), csv_of(clip, short_part({})));
  ASSERT_TRUE(motion.plan.travel);
  EXPECT_EQ(motion.plan.travel->factor, 1.0);
}

TEST(TravelOfMotions, AutoShortensAFastWalk) {
  // Three times as fast as it was recorded.
  const Clip fast = clip_at_rate("walk", 90.0);
  const Motion whole = solved(fast, {}), shorter = solved(fast, with_travel("auto"));
  EXPECT_NEAR(shorter.plan.travel->least, 0.85, 1e-9);
  EXPECT_NEAR(way(shorter.clip) / way(whole.clip), shorter.plan.travel->factor, 0.02);
  EXPECT_LT(shorter.plan.travel->factor, 0.9);
}

TEST(TravelOfMotions, AutoComparesFroudeNumbers) {
  // The longer the legs, the faster the robot for its size, because the duration does not change.
  const Clip clip = clip_at_rate("walk", 50.0);
  const double small = travel_of(clip, robot_named("booster_k1")),
               g1_s = travel_of(clip, loaded_g1()),
               tall = travel_of(clip, robot_named("unitree_h1"));
  EXPECT_LT(tall, g1_s);
  EXPECT_LT(g1_s, small);
}

TEST(TravelOfMotions, FeetStayPlantedWhileTheFactorChanges) {
  Clip clip = accelerated(clip_at_rate("walk", 45.0));
  const Motion motion = solved(std::move(clip), with_travel("auto"));
  ASSERT_GT(motion.plan.travel->greatest - motion.plan.travel->least, 0.05);
  const QualityReport report = evaluate(motion).value();
  for (const GateResult& gate : report.gates) {
    const bool of_feet = gate.metric.starts_with("stance_") || gate.metric == "root_slide_mean" ||
                         gate.metric == "source_slide_mean" || gate.metric == "lag_s";
    if (!of_feet) continue;
    EXPECT_TRUE(gate.value && gate.passed) << gate.metric;
  }
}

TEST(TravelOfMotions, PlanAndSummaryStateTheFactor) {
  const auto plan = value_of(make_plan(clip_at_rate("walk"), loaded_g1(), with_travel("0.8")));
  EXPECT_THAT(plan.summary(), HasSubstr("the path over the ground is scaled by 0.8"));
  const auto without = value_of(make_plan(clip_at_rate("walk"), loaded_g1(), {}));
  EXPECT_FALSE(without.travel);
}

TEST(TravelOfMotions, AFixedBaseDoesNotTravel) {
  RobotChoice choice;
  choice.name = "unitree_g1";
  choice.base = RobotBase::kFixed;
  const LoadedRobot robot = load_robot(choice, {kRepository}).value();
  const auto plan = value_of(make_plan(clip_at_rate("wave"), robot, with_travel("0.8")));
  EXPECT_FALSE(plan.travel);
  EXPECT_THAT(plan.summary(), HasSubstr("the base is fixed: no path to scale"));
}

TEST(TravelOfMotions, InvalidFactorsAreUsageErrors) {
  for (const char* travel : {"fast", "0.4", "1.3", "nan", "automatic"}) {
    const auto plan = make_plan(clip_at_rate("wave"), loaded_g1(), with_travel(travel));
    ASSERT_FALSE(plan) << travel;
    EXPECT_EQ(plan.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(describe(plan.error()), HasSubstr("expected a number from 0.5 to 1.2 or `auto`"));
  }
}

TEST(Preset, IsRejectedForThePublishedMethod) {
  for (Options options : {with_travel("0.9"), for_tracking()}) {
    options.solve.method = Method::kGmr;
    const auto plan = make_plan(clip_at_rate("wave"), loaded_g1(), options);
    ASSERT_FALSE(plan);
    EXPECT_THAT(describe(plan.error()), HasSubstr("require method fit"));
  }
}

TEST(Preset, EqualsItsOptions) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "fit.json").string();
  const FitOptions usual;
  FitOptions chosen = fit_of(for_tracking());
  EXPECT_DOUBLE_EQ(chosen.smoothness_root_reference, 0.0);
  EXPECT_DOUBLE_EQ(chosen.smoothness_root_position, 40.0);
  EXPECT_DOUBLE_EQ(chosen.limb_smoothing_time, 0.0);
  EXPECT_DOUBLE_EQ(chosen.smoothness_root_rotation, 2.0 * usual.smoothness_root_rotation);
  const double smoother = chosen.smoothness_leg / usual.smoothness_leg;
  EXPECT_GE(smoother, 2.0);
  EXPECT_LE(smoother, 4.0);
  EXPECT_DOUBLE_EQ(chosen.smoothness_arm, smoother * usual.smoothness_arm);
  EXPECT_DOUBLE_EQ(chosen.smoothness_wrist, smoother * usual.smoothness_wrist);
  ASSERT_TRUE(write_file(file, options_text(fit_table(chosen))));
  Options options = with_travel("auto");
  options.solve.fit_config = file;
  const Clip clip = clip_at_rate("walk", 50.0);
  EXPECT_EQ(csv_of(clip, short_part(for_tracking())), csv_of(clip, short_part(options)));
  EXPECT_NE(csv_of(clip, short_part(for_tracking())), csv_of(clip, short_part({})));
}

TEST(Dynamics, AreOffInScenesAndForRobotMotionsUnlessGiven) {
  for (const bool of_robot : {false, true}) {
    Options options;
    if (!of_robot) options.solve.terrain = "stairs:0.1x0.3";
    const auto has_dynamics = [&] {
      const auto setup = value_of(set_up_robot(loaded_g1(), options));
      return (of_robot ? setup.fit_of_robots : setup.fit).dynamics;
    };
    EXPECT_FALSE(has_dynamics());
    options.solve.fit_given = {"dynamics"};
    EXPECT_TRUE(has_dynamics());
    options.solve.fit_given = {};
    options.solve.with = {"dynamics"};
    EXPECT_TRUE(has_dynamics());
  }
}

TEST(Preset, GivenOptionsTakePrecedence) {
  const TemporaryFolder folder;
  Options options = for_tracking();
  options.solve.without = {"dynamics"};
  EXPECT_FALSE(fit_of(options).dynamics);

  options = for_tracking();
  options.solve.fit_config = (folder.path() / "fit.json").string();
  ASSERT_TRUE(
      write_file(options.solve.fit_config, R"({"smoothness_leg": 1.75, "dynamics": false})"));
  EXPECT_EQ(fit_of(options).smoothness_leg, 1.75);
  EXPECT_FALSE(fit_of(options).dynamics);
  EXPECT_NE(fit_of(options).smoothness_arm, FitOptions().smoothness_arm);

  options = for_tracking();
  options.solve.fit.smoothness_arm = 2.0;
  EXPECT_EQ(fit_of(options).smoothness_arm, 2.0);

  options = for_tracking();
  options.solve.fit_given = {"smoothness_wrist"};
  EXPECT_EQ(fit_of(options).smoothness_wrist, FitOptions().smoothness_wrist);

  options = for_tracking();
  options.solve.travel = "1";
  const auto plan = value_of(make_plan(clip_at_rate("walk", 90.0), loaded_g1(), options));
  EXPECT_EQ(plan.travel->least, 1.0);
}

TEST(Preset, AnyNumberOfThreadsGivesTheSameBytes) {
  Options options = for_tracking();
  options.solve.fit_window_s = 3.0;
  const Clip clip = clip_at_rate("walk", 50.0);
  EXPECT_EQ(format_robot_csv(solved(clip, options, 1).clip),
            format_robot_csv(solved(clip, options, 2).clip));
}

TEST(Preset, RecordsContainItOnlyIfGiven) {
  retarget::Run run;
  EXPECT_EQ(options_text(run_table(run)).find("\"travel\""), std::string::npos);
  EXPECT_EQ(options_text(run_table(run)).find("\"for\""), std::string::npos);
  run.options.solve.travel = "0.9";
  run.options.solve.purpose = Purpose::kTracking;
  EXPECT_THAT(options_text(run_table(run)), HasSubstr("\"travel\": \"0.9\""));
  EXPECT_THAT(options_text(run_table(run)), HasSubstr("\"for\": \"tracking\""));
}

}  // namespace
}  // namespace retarget
