// End of the iteration: only a fit that does not converge is reported.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/bvh/read_bvh.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/fit.h"
#include "solve/fit/fit_report.h"
#include "solve/targets/targets.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::HasSubstr;

class FitStatusTest : public testing::Test {
 protected:
  void SetUp() override {
    robot_ = load_g1();
    config_ = published_config(*robot_);
  }

  FitResult result_of(const FitOptions& options) {
    const Clip clip = cut(recorded_clip("walk"), 60, 120);
    const Calibration calibration = lafan1_calibration(clip.skeleton());
    return value_of(fit(clip, calibration, robot_, config_, robot_->model_limits(), options));
  }
  FitReport report_of(const FitOptions& options) { return result_of(options).report; }

  std::shared_ptr<const Robot> robot_;
  ResolvedConfig config_;
};

TEST_F(FitStatusTest, DoesNotReportAClipThatConverges) {
  const FitReport report = report_of({});
  EXPECT_TRUE(report.status.converged);
  EXPECT_GE(report.status.steps, FitOptions{}.iterations);
  EXPECT_LT(report.status.steps, FitOptions{}.iterations + FitOptions{}.extra_iterations);
  EXPECT_EQ(report.status.failed_blocks, 0);
  EXPECT_LE(report.status.predicted_decrease, kFitTolerance);
  EXPECT_GT(report.status.predicted_decrease, 0.0);
  EXPECT_LT(report.status.cost_after, 0.7 * report.status.cost_before);
  EXPECT_EQ(convergence_note(report), "");
}

TEST_F(FitStatusTest, OneStepIsNotEnough) {
  FitOptions options;
  options.iterations = 1;
  options.extra_iterations = 0;
  const FitReport report = report_of(options);
  EXPECT_FALSE(report.status.converged);
  EXPECT_EQ(report.status.steps, 1);
  EXPECT_GT(report.status.predicted_decrease, kFitTolerance);
  EXPECT_THAT(convergence_note(report), HasSubstr("not converged after 1 step"));
}

TEST_F(FitStatusTest, ContinuesWindowsThatHaveNotConverged) {
  FitOptions options;
  options.iterations = 2;
  options.anchor_iterations = 1;
  options.dynamics = false;
  const FitReport report = report_of(options);
  EXPECT_TRUE(report.status.converged);
  EXPECT_GT(report.status.steps, 2);
  EXPECT_LE(report.status.steps, 2 + options.extra_iterations);
}

// A squat moves hips and waist while the feet stand. Damping in proportion to the curvature of the
// contacts nearly stops this movement: the cost stays three times as high.
TEST_F(FitStatusTest, ReachesTheCostOfManyStepsInASquat) {
  const Clip clip = recorded_clip("squat");
  const auto cost_of = [&](const FitOptions& options) {
    const auto result = fit(clip, lafan1_calibration(clip.skeleton()), robot_, config_,
                            robot_->model_limits(), options);
    return result->report.status.cost_after;
  };
  FitOptions many;
  many.iterations = 60;
  EXPECT_LT(cost_of({}), 1.05 * cost_of(many));
}

TEST_F(FitStatusTest, WithoutAStepNothingConverges) {
  FitOptions options;
  options.iterations = 0;
  const FitReport report = report_of(options);
  EXPECT_FALSE(report.status.converged);
  EXPECT_EQ(report.status.steps, 0);
  EXPECT_THAT(convergence_note(report), HasSubstr("no step was taken in frames 0 to 59"));
}

TEST_F(FitStatusTest, SummarisesWindows) {
  FitOptions options;
  options.window = 0.7;
  const FitReport report = report_of(options);
  double before = 0.0, after = 0.0, decrease = 0.0;
  int frames = 0;
  for (const FitStatus& part : report.windows) {
    EXPECT_EQ(part.converged, part.predicted_decrease <= kFitTolerance);
    decrease = std::max(decrease, part.predicted_decrease);
    // Seams come last and begin before the end of the windows.
    if (part.begin != frames) break;
    frames = part.end;
    before += part.cost_before;
    after += part.cost_after;
  }
  EXPECT_GT(report.windows.size(), 1U);
  EXPECT_EQ(frames, report.status.end);
  EXPECT_NEAR(before, report.status.cost_before, 1e-9 * before);
  EXPECT_NEAR(after, report.status.cost_after, 1e-9 * after);
  EXPECT_LE(decrease, report.status.predicted_decrease);
}

// NaN targets add no equations: their frames do not change, and the status reports them.
TEST_F(FitStatusTest, BlocksThatAreNotFiniteAreCounted) {
  const TargetBuilder targets(config_, 1.75);
  BoneArray<int> target_of_bone;
  for (const Bone bone : kAllBones) target_of_bone[bone] = targets.target_of(bone);
  FitOptions options;
  const FitModel model =
      make_fit_model(*robot_, config_, robot_->model_limits(), target_of_bone, options);
  FitClip clip;
  clip.frame_count = 4;
  clip.feet.foot_count = static_cast<int>(model.feet.size());
  clip.feet.ends.resize(4 * 2 * model.feet.size());
  clip.feet.upright.resize(4 * model.feet.size());
  clip.targets.resize(4 * model.tasks.size());
  clip.targets.back().position.fill(std::numeric_limits<double>::quiet_NaN());
  for (int t = 0; t < 4; ++t) {
    const auto qpos = robot_->zero_configuration();
    clip.qpos.insert(clip.qpos.end(), qpos.begin(), qpos.end());
  }
  const std::vector<double> before = clip.qpos;
  const FitStatus status = fit_window(model, options, {0, 4}, clip, {});
  EXPECT_FALSE(status.converged);
  EXPECT_EQ(status.steps, 0);
  EXPECT_EQ(status.failed_blocks, options.iterations);
  EXPECT_TRUE(status.failed);
  EXPECT_EQ(clip.qpos, before);
  // The same in a moving window, which is empty at first.
  clip.frame_count = 0;
  const auto moving = make_moving_fit(model, options, clip, 0);
  clip.frame_count = 4;
  moving->move(0, 0);
  EXPECT_FALSE(moving->step());
  EXPECT_EQ(clip.qpos, before);
  clip.targets.back().position.setZero();
  EXPECT_TRUE(moving->step());
  EXPECT_NE(clip.qpos, before);
}

// Weights with infinite squares.
TEST_F(FitStatusTest, StepsThatAreNotFiniteAreAFailure) {
  FitOptions options;
  options.smoothness_leg = 1e200;
  const FitResult failed = result_of(options);
  EXPECT_TRUE(failed.report.status.failed);
  EXPECT_FALSE(failed.report.status.converged);
  EXPECT_EQ(failed.report.status.steps, 0);
  ASSERT_EQ(failed.report.failures.size(), 1U);
  EXPECT_EQ(failed.report.failures[0].solver, "fit");
  EXPECT_EQ(failed.report.failures[0].begin, 0);
  EXPECT_EQ(failed.report.failures[0].end, 60);
  for (int t = 0; t < 60; ++t) {
    for (const double value : failed.clip.qpos(t)) EXPECT_TRUE(std::isfinite(value)) << t;
  }
  EXPECT_TRUE(result_of({}).report.failures.empty());
}

TEST_F(FitStatusTest, DynamicsThatAreNotFiniteLeaveTheFitWithoutThem) {
  FitOptions options;
  options.dynamics = false;
  const FitResult without = result_of(options);
  options.dynamics = true;
  options.com_weight = 1e200;
  const FitResult failed = result_of(options);
  EXPECT_TRUE(failed.report.status.dynamics_failed);
  EXPECT_FALSE(failed.report.status.failed);
  ASSERT_EQ(failed.report.failures.size(), 1U);
  EXPECT_EQ(failed.report.failures[0].solver, "fit with dynamics");
  for (int t = 0; t < 60; ++t) {
    for (std::size_t i = 0; i < failed.clip.qpos(t).size(); ++i) {
      EXPECT_EQ(failed.clip.qpos(t)[i], without.clip.qpos(t)[i]) << t;
    }
  }
}

}  // namespace
}  // namespace retarget
