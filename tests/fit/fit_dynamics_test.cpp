// The term `dynamics` moves the body to where contacts can supply the forces, without damage to the
// other terms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "retarget/clip_range.h"
#include "retarget/resample.h"
#include "robot/shipped_robots.h"
#include "solve/dynamics/motion_dynamics.h"
#include "solve/fit/fit.h"
#include "support/lafan1_map.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

Clip sampled_frames(const std::string& name, int begin, int end) {
  auto clip = load_bvh(RETARGET_SOURCE_DIR "/data/" + name);
  EXPECT_TRUE(clip.has_value());
  return cut(clip->clip, begin, end);
}

FitOptions without_dynamics() {
  FitOptions options;
  options.dynamics = false;
  return options;
}

class FitDynamicsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot_ = load_g1(); }
  static void TearDownTestSuite() { robot_.reset(); }

  FitResult fitted(const Clip& clip, const FitOptions& options) {
    const auto limits = load_limits(*robot_, "official");
    auto result = fit(clip, lafan1_calibration(clip.skeleton()), robot_, published_config(*robot_),
                      *limits, options);
    EXPECT_TRUE(result.has_value()) << describe(result.error());
    return std::move(*result);
  }

  // Share of the time in which contacts cannot supply the required forces.
  double bad_share(const RobotClip& clip) {
    const MotionDynamics dynamics = analyse_dynamics(clip);
    const auto bad = std::ranges::count_if(dynamics.samples, &DynamicsSample::is_bad);
    return static_cast<double>(bad) / static_cast<double>(dynamics.samples.size());
  }

  static double largest_difference(const RobotClip& a, const RobotClip& b) {
    double largest = 0.0;
    for (int t = 0; t < a.frame_count(); ++t) {
      for (std::size_t i = 0; i < a.qpos(t).size(); ++i) {
        largest = std::max(largest, std::abs(a.qpos(t)[i] - b.qpos(t)[i]));
      }
    }
    return largest;
  }

  static std::shared_ptr<const Robot> robot_;
};
std::shared_ptr<const Robot> FitDynamicsTest::robot_;

TEST_F(FitDynamicsTest, MakesAWalkFeasible) {
  const Clip walk = sampled_frames("walk.bvh", 60, 240);
  const FitResult without = fitted(walk, without_dynamics()), with = fitted(walk, {});
  const double before = bad_share(without.clip), after = bad_share(with.clip);
  EXPECT_GT(before, 0.1);
  EXPECT_LT(after, 0.3 * before);
  EXPECT_EQ(with.report.status.distrusted_frames, 0);
  // A few centimetres and degrees suffice.
  EXPECT_LT(largest_difference(without.clip, with.clip), 0.3);
  const auto contact = [](const FitResult& result) {
    return std::ranges::find(result.report.terms, "contact", &FitTermReport::name)->after;
  };
  EXPECT_LT(contact(with), contact(without) + 1.0);
}

// The H1's ankles hold half the length of its soles. Here 0.49 -> 0.37 of the samples are over a limit.
TEST_F(FitDynamicsTest, SparesWeakAnkles) {
  const auto robot = load_shipped("unitree_h1");
  const auto config = load_config(RETARGET_SOURCE_DIR "/robots/unitree_h1/ik.json", *robot);
  ASSERT_TRUE(config.has_value()) << describe(config.error());
  const auto limits = load_limits(*robot, "model");
  ASSERT_TRUE(limits.has_value()) << describe(limits.error());
  const Clip walk = sampled_frames("walk.bvh", 60, 180);
  const auto over_share = [&](const FitOptions& options) {
    const auto result =
        fit(walk, lafan1_calibration(walk.skeleton()), robot, *config, *limits, options);
    EXPECT_TRUE(result.has_value()) << describe(result.error());
    const MotionDynamics dynamics = analyse_dynamics(result->clip);
    const auto over = std::ranges::count_if(
        dynamics.samples, [](const DynamicsSample& sample) { return sample.torque_ratio > 1.0; });
    return static_cast<double>(over) / static_cast<double>(dynamics.samples.size());
  };
  const double without = over_share(without_dynamics());
  EXPECT_GT(without, 0.2);
  EXPECT_LT(over_share({}), 0.85 * without);
}

double root_jerk(const RobotClip& clip) {
  const auto root = [&clip](int t) { return Eigen::Vector3d(clip.qpos(t).data()); };
  const double fps = clip.rate().fps();
  double sum = 0.0;
  for (int t = 0; t + 3 < clip.frame_count(); ++t) {
    sum += (root(t + 3) - 3.0 * root(t + 2) + 3.0 * root(t + 1) - root(t)).norm();
  }
  return sum * fps * fps * fps / (clip.frame_count() - 3);
}

// At every rate the walk becomes feasible, and is hardly rougher than without the term.
TEST_F(FitDynamicsTest, IsIndependentOfTheFrameRate) {
  const Clip walk = sampled_frames("walk.bvh", 60, 160);
  for (const double fps : {24.0, 50.0, 120.0}) {
    const auto at_rate = resample(walk, frame_rate_from_fps(fps));
    ASSERT_TRUE(at_rate.has_value());
    const FitResult without = fitted(*at_rate, without_dynamics()), with = fitted(*at_rate, {});
    EXPECT_GT(bad_share(without.clip), 0.1) << fps;
    EXPECT_LT(bad_share(with.clip), 0.35 * bad_share(without.clip)) << fps;
    EXPECT_LT(root_jerk(with.clip), 1.3 * root_jerk(without.clip)) << fps;
  }
}

// Also with short windows, whose seams are close together.
TEST_F(FitDynamicsTest, ThreadsDoNotChangeTheResult) {
  const Clip walk = sampled_frames("walk.bvh", 60, 240);
  for (const double window : {2.0, 0.3}) {
    FitOptions options;
    options.window = window;
    options.threads = 1;
    const RobotClip one = fitted(walk, options).clip;
    for (const int threads : {2, 8}) {
      options.threads = threads;
      EXPECT_EQ(largest_difference(one, fitted(walk, options).clip), 0.0) << window;
    }
  }
}

// Getting up on hands without planned contacts: the result equals the one without the term, bit for
// bit.
TEST_F(FitDynamicsTest, IsRevertedIfItDoesNotImproveTheFit) {
  // The term is active in the first step, when positions and limbs are not yet solved.
  const Clip rising = sampled_frames("get_up.bvh", 180, 240);
  FitOptions too_early;
  too_early.dynamics_iterations = too_early.iterations;
  const FitResult with = fitted(rising, too_early), without = fitted(rising, without_dynamics());
  ASSERT_TRUE(with.report.windows.front().dynamics_taken_back);
  EXPECT_EQ(largest_difference(without.clip, with.clip), 0.0);
  EXPECT_EQ(with.report.status.steps, without.report.status.steps);
  EXPECT_THAT(with.report.notes, testing::Contains(testing::HasSubstr("no improvement")));
}

// Standing and waving need no forces beyond those of the contacts, so the motion is equal bit for
// bit.
TEST_F(FitDynamicsTest, DoesNotChangeFeasibleMotion) {
  const Clip wave = sampled_frames("wave.bvh", 0, 120);
  const FitResult with = fitted(wave, {}), without = fitted(wave, without_dynamics());
  EXPECT_EQ(bad_share(without.clip), 0.0);
  EXPECT_EQ(largest_difference(without.clip, with.clip), 0.0);
  EXPECT_EQ(with.report.status.steps, without.report.status.steps);
}

// The robot hangs in the air without a known support: the term does not move it.
TEST_F(FitDynamicsTest, DoesNotMoveAHangingRobot) {
  Clip walk = sampled_frames("walk.bvh", 60, 130);
  for (int t = 0; t < walk.frame_count(); ++t) {
    // The body rises by a metre as in a lift, with its feet drawn up.
    walk.translations(t)[0].y() += 100.0 * std::clamp((t - 10) / 20.0, 0.0, 1.0);
  }
  const FitResult without = fitted(walk, without_dynamics()), with = fitted(walk, {});
  EXPECT_GT(with.report.status.distrusted_frames, 20);
  EXPECT_LE(bad_share(with.clip), bad_share(without.clip) + 0.02);
  EXPECT_THAT(with.report.notes,
              testing::Contains(testing::HasSubstr("of the frames remain unchanged")));
}

// The body rises and sinks as on a trampoline, so unknown supports carry it in most frames: the
// result equals the one without the term, bit for bit.
TEST_F(FitDynamicsTest, IsRevertedIfMostSupportsAreUnknown) {
  Clip walk = sampled_frames("walk.bvh", 60, 180);
  for (int t = 0; t < walk.frame_count(); ++t) {
    walk.translations(t)[0].y() += 8.0 * (1.0 - std::cos(2.0 * M_PI * t / 45.0));
  }
  const FitResult without = fitted(walk, without_dynamics()), with = fitted(walk, {});
  EXPECT_TRUE(with.report.windows.front().dynamics_taken_back);
  EXPECT_EQ(largest_difference(without.clip, with.clip), 0.0);
  EXPECT_GT(bad_share(without.clip), 0.55);
}

TEST_F(FitDynamicsTest, HandlesShortClips) {
  for (const int frames : {1, 2, 3, 5}) {
    const FitResult result = fitted(sampled_frames("walk.bvh", 60, 60 + frames), {});
    EXPECT_EQ(result.clip.frame_count(), frames);
  }
}

}  // namespace
}  // namespace retarget
