// The whole fit on the repository's samples: guarantees, feet, odd clips, windows and threads.

#include "solve/fit/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "formats/bvh/read_bvh.h"
#include "retarget/resample.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::HasSubstr;

class FitTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot_ = load_g1(); }
  static void TearDownTestSuite() { robot_.reset(); }

  void SetUp() override {
    config_ = published_config(*robot_);
    limits_ = value_of(load_limits(*robot_, "official"));
  }

  FitResult fitted(const Clip& clip, const FitOptions& options = {}, const FitRun& run = {}) {
    const Calibration calibration = lafan1_calibration(clip.skeleton());
    return value_of(fit(clip, calibration, robot_, config_, limits_, options, run));
  }

  // Guarantees for every motion, checked on the printed values.
  void expect_guarantees(const RobotClip& clip, const FitOptions& options = {}) {
    const double dt = clip.rate().frame_time();
    const auto printed = [](double x) { return std::round(x * 1e6) / 1e6; };
    constexpr double kSlack = 1e-9;
    for (int t = 0; t < clip.frame_count(); ++t) {
      const auto q = clip.qpos(t);
      for (const double x : q) ASSERT_TRUE(std::isfinite(x));
      double norm = 0.0, dot = 0.0;
      for (std::size_t i = 3; i < 7; ++i) {
        norm += q[i] * q[i];
        if (t > 0) dot += q[i] * clip.qpos(t - 1)[i];
      }
      EXPECT_NEAR(norm, 1.0, 1e-9);
      EXPECT_GE(dot, 0.0);
      for (std::size_t j = 0; j < robot_->joints().size(); ++j) {
        const RobotJoint& joint = robot_->joints()[j];
        const auto address = static_cast<std::size_t>(joint.qpos_address);
        const double now = printed(q[address]);
        EXPECT_GE(now, limits_.lower[j] - kSlack) << joint.name << " " << t;
        EXPECT_LE(now, limits_.upper[j] + kSlack) << joint.name << " " << t;
        if (t == 0) continue;
        const double step = std::abs(now - printed(clip.qpos(t - 1)[address]));
        const double limit = robot_->profile().speed_limits.at(joint.name);
        EXPECT_LE(step, limit * dt + kSlack) << joint.name << " " << t;
        EXPECT_LE(step, options.max_joint_step + kSlack) << joint.name << " " << t;
      }
    }
  }

  // Heights of all sole points of a foot, lowest per frame.
  std::vector<double> sole_heights(const RobotClip& clip) {
    std::vector<Pose> bodies(robot_->bodies().size());
    std::vector<double> heights;
    for (int t = 0; t < clip.frame_count(); ++t) {
      forward_kinematics(*robot_, clip.qpos(t), bodies);
      double lowest = 1e9;
      for (const Sole& sole : robot_->profile().soles) {
        for (const auto& point : sole.points) {
          lowest = std::min(lowest, (bodies[static_cast<std::size_t>(sole.body)] * point).z());
        }
      }
      heights.push_back(lowest);
    }
    return heights;
  }

  static std::shared_ptr<const Robot> robot_;
  ResolvedConfig config_;
  LimitSet limits_;
};
std::shared_ptr<const Robot> FitTest::robot_;

TEST_F(FitTest, WalkStandsOnTheFloorWithoutSliding) {
  const FitResult result = fitted(cut(recorded_clip("walk"), 60, 120));
  expect_guarantees(result.clip);
  EXPECT_TRUE(result.report.floor_found);
  EXPECT_GT(result.report.contact_phases, 2);
  // One foot is always on the floor, and none below it.
  for (const double height : sole_heights(result.clip)) {
    EXPECT_GT(height, -0.01);
    EXPECT_LT(height, 0.02);
  }
  // The contact cost of a frame is small: one millimetre of deviation costs 0.25.
  const auto contact = std::ranges::find(result.report.terms, "contact", &FitTermReport::name);
  ASSERT_NE(contact, result.report.terms.end());
  EXPECT_LT(contact->after, 0.5);
  EXPECT_LT(contact->after, contact->before);
}

TEST_F(FitTest, FeetStandOnRaisedSupports) {
  // Everything is lifted by 0.3 m within a third of a second, as by a platform that starts and
  // stops smoothly.
  Clip clip = cut(recorded_clip("wave"), 0, 70);
  constexpr int kFirst = 30, kLast = 40;
  for (int t = kFirst; t < clip.frame_count(); ++t) {
    const double way = std::min(1.0, static_cast<double>(t - kFirst) / (kLast - kFirst));
    clip.translations(t)[0].y() += 30.0 * way * way * (3.0 - 2.0 * way);
  }
  // The dynamics do not know the force of the platform, and let the feet slide at its edges.
  FitOptions options;
  options.dynamics = false;
  const FitResult result = fitted(clip, options);
  expect_guarantees(result.clip);
  const std::vector<double> heights = sole_heights(result.clip);
  EXPECT_NEAR(heights[20], 0.0, 0.002);
  // The foot path of the G1 is a little shorter than the source's.
  EXPECT_GT(heights[60], 0.22);
  EXPECT_LT(heights[60], 0.3);
  std::vector<Pose> before(robot_->bodies().size()), now = before;
  for (int t = kLast + 5; t < clip.frame_count(); ++t) {
    EXPECT_NEAR(heights[static_cast<std::size_t>(t)], heights[60], 0.001);
    forward_kinematics(*robot_, result.clip.qpos(t - 1), before);
    forward_kinematics(*robot_, result.clip.qpos(t), now);
    for (const Sole& sole : robot_->profile().soles) {
      const auto body = static_cast<std::size_t>(sole.body);
      for (const auto& point : sole.points) {
        EXPECT_LT((now[body] * point - before[body] * point).norm() * 30.0, 0.005) << t;
      }
    }
  }
}

TEST_F(FitTest, ContactPositionsConverge) {
  // One more step hardly changes the motion.
  const Clip clip = cut(recorded_clip("walk"), 60, 120);
  FitOptions options;
  options.anchor_iterations = 7;
  const RobotClip seven = fitted(clip, options).clip;
  options.anchor_iterations = 8;
  const RobotClip eight = fitted(clip, options).clip;
  double max = 0.0;
  for (int t = 0; t < clip.frame_count(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      max = std::max(max, std::abs(seven.qpos(t)[i] - eight.qpos(t)[i]));
    }
  }
  EXPECT_LT(max, 0.002);
}

TEST_F(FitTest, SamplesSatisfyTheGuarantees) {
  for (const char* name : {"get_up", "squat", "turn_in_place", "wave"}) {
    SCOPED_TRACE(name);
    FitOptions options;
    options.iterations = 3;
    expect_guarantees(fitted(cut(recorded_clip(name), 40, 58), options).clip);
  }
}

TEST_F(FitTest, JointsStayAwayFromTheirLimits) {
  // The ankles cannot roll as far as the walk requires.
  const auto address = [&](const char* name) {
    const auto joint = std::ranges::find(robot_->joints(), name, &RobotJoint::name);
    const auto index = static_cast<std::size_t>(joint - robot_->joints().begin());
    limits_.lower[index] = -0.02;
    limits_.upper[index] = 0.02;
    return static_cast<std::size_t>(joint->qpos_address);
  };
  const std::size_t left = address("left_ankle_roll_joint");
  const std::size_t right = address("right_ankle_roll_joint");
  const Clip clip = cut(recorded_clip("walk"), 30, 120);
  const auto frames_at_a_stop = [&](double weight) {
    FitOptions options;
    options.limit_margin_weight = weight;
    const RobotClip fit = fitted(clip, options).clip;
    int count = 0;
    for (int t = 0; t < fit.frame_count(); ++t) {
      const auto q = fit.qpos(t);
      if (std::max(std::abs(q[left]), std::abs(q[right])) > 0.0196) ++count;
    }
    return count;
  };
  EXPECT_GT(frames_at_a_stop(0.0), 30);
  EXPECT_LE(frames_at_a_stop(FitOptions{}.limit_margin_weight), 1);
}

TEST_F(FitTest, NarrowLimitsHoldAndAreReported) {
  // No joint may turn faster than a quarter turn per second.
  FitOptions options;
  options.max_joint_speed = 0.6;
  options.iterations = 2;
  const FitResult result = fitted(cut(recorded_clip("walk"), 60, 90), options);
  expect_guarantees(result.clip);
  ASSERT_FALSE(result.report.bounded.empty());
  EXPECT_GT(result.report.bounded.front().largest, 0.0);
  const double dt = result.clip.rate().frame_time();
  for (int t = 1; t < result.clip.frame_count(); ++t) {
    for (std::size_t i = 7; i < result.clip.qpos(t).size(); ++i) {
      EXPECT_LE(std::abs(result.clip.qpos(t)[i] - result.clip.qpos(t - 1)[i]), 0.6 * dt);
    }
  }
}

TEST_F(FitTest, BoundsHoldForImpossibleSources) {
  // Random joint values in every frame, and a root that jumps by metres.
  const Clip walk = recorded_clip("walk");
  for (const unsigned seed : {1U}) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Clip clip = cut(walk, 0, 10);
    for (int t = 0; t < clip.frame_count(); ++t) {
      for (auto& rotation : clip.rotations(t)) {
        rotation = Eigen::Quaterniond(normal(random), normal(random), normal(random),
                                      normal(random) + 1e-3)
                       .normalized();
      }
      for (auto& translation : clip.translations(t)) {
        translation += 100.0 * Eigen::Vector3d(normal(random), normal(random), normal(random));
      }
    }
    for (const int iterations : {0, 3}) {
      FitOptions options;
      options.iterations = iterations;
      expect_guarantees(fitted(clip, options).clip, options);
      // Other paths of the arms keep the bounds on speeds by themselves.
      FitRun run;
      run.recover_limbs = false;
      const FitResult result = fitted(clip, options, run);
      expect_guarantees(result.clip, options);
      EXPECT_FALSE(result.report.bounded.empty());
    }
  }
}

TEST_F(FitTest, OverlappingFeetAreSeparated) {
  // The T1 is small but its feet are not: a source with feet side by side.
  const auto robot = load_robot_in(RETARGET_SOURCE_DIR "/robots/booster_t1_29dof");
  const auto config =
      value_of(load_config(RETARGET_SOURCE_DIR "/configs/lafan1_to_booster_t1_29dof.json", *robot));
  const Clip clip = cut(recorded_clip("wave"), 0, 8);
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  const auto result =
      value_of(fit(clip, calibration, robot, config, robot->model_limits(), FitOptions{}));
  const auto overlap =
      std::ranges::find(result.report.terms, "self-collision", &FitTermReport::name);
  ASSERT_NE(overlap, result.report.terms.end());
  EXPECT_GT(overlap->before, 100.0);
  // The remaining violation is smaller than the margin.
  const FitOptions options;
  EXPECT_LT(overlap->after,
            std::pow(options.self_collision_weight * options.self_collision_margin, 2));
}

TEST_F(FitTest, HandlesClipsOfOneAndTwoFrames) {
  const Clip whole = recorded_clip("walk");
  for (const int frames : {1, 2, 3}) {
    const FitResult result = fitted(cut(whole, 10, 10 + frames));
    EXPECT_EQ(result.clip.frame_count(), frames);
    expect_guarantees(result.clip);
  }
}

TEST_F(FitTest, ThreadCountDoesNotChangeTheResult) {
  // 13 windows and their seams; the first ones are solved before the last ones have their start.
  FitOptions options;
  options.window = 0.8;
  options.seam = 0.1;
  options.iterations = 3;
  options.threads = 1;
  const Clip clip = recorded_clip("walk");
  const FitResult one = fitted(clip, options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    const FitResult many = fitted(clip, options);
    for (int t = 0; t < one.clip.frame_count(); ++t) {
      ASSERT_TRUE(std::ranges::equal(one.clip.qpos(t), many.clip.qpos(t))) << threads << " " << t;
    }
    for (std::size_t i = 0; i < one.report.terms.size(); ++i) {
      EXPECT_EQ(one.report.terms[i].before, many.report.terms[i].before) << threads;
      EXPECT_EQ(one.report.terms[i].after, many.report.terms[i].after) << threads;
    }
  }
}

TEST_F(FitTest, MotionDoesNotDependOnTheCostsInTheReport) {
  const Clip clip = recorded_clip("squat");
  FitRun run;
  run.costs = false;
  const FitResult with = fitted(clip), without = fitted(clip, {}, run);
  for (int t = 0; t < with.clip.frame_count(); ++t) {
    ASSERT_TRUE(std::ranges::equal(with.clip.qpos(t), without.clip.qpos(t))) << t;
  }
  EXPECT_FALSE(with.report.terms.empty());
  EXPECT_GT(with.report.status.cost_before, 0.0);
  EXPECT_TRUE(without.report.terms.empty());
  EXPECT_EQ(without.report.status.cost_before, 0.0);
  EXPECT_EQ(with.report.status.converged, without.report.status.converged);
}

TEST_F(FitTest, WindowsMatchTheWholeClip) {
  const Clip clip = cut(recorded_clip("walk"), 40, 110);
  FitOptions options;
  options.iterations = 8;
  options.self_collision = false;
  options.dynamics = false;
  options.window = 1000.0;
  const RobotClip whole = fitted(clip, options).clip;
  options.window = 1.1;
  options.seam = 0.27;
  const RobotClip windows = fitted(clip, options).clip;
  expect_guarantees(windows);
  double sum = 0.0, max = 0.0;
  for (int t = 0; t < whole.frame_count(); ++t) {
    for (std::size_t i = 0; i < whole.qpos(t).size(); ++i) {
      const double difference = std::abs(whole.qpos(t)[i] - windows.qpos(t)[i]);
      sum += difference / static_cast<double>(whole.qpos(t).size() * whole.frame_count());
      max = std::max(max, difference);
    }
  }
  EXPECT_LT(sum, 0.003);
  EXPECT_LT(max, 0.1);
}

TEST_F(FitTest, IsIndependentOfTheFrameRate) {
  const Clip clip = cut(recorded_clip("walk"), 60, 90);
  const auto faster = value_of(resample(clip, frame_rate_from_fps(60.0), {}));
  FitOptions options;
  options.iterations = 8;
  options.self_collision = false;
  const RobotClip at_30 = fitted(clip, options).clip, at_60 = fitted(faster, options).clip;
  expect_guarantees(at_60);
  double sum = 0.0;
  for (int t = 0; t < at_30.frame_count(); ++t) {
    for (std::size_t i = 0; i < at_30.qpos(t).size(); ++i) {
      sum += std::abs(at_30.qpos(t)[i] - at_60.qpos(2 * t)[i]);
    }
  }
  EXPECT_LT(sum / (36.0 * at_30.frame_count()), 0.01);
}

// Their largest acceleration does not grow with the rate as if they started within a frame: that
// would be 280 m/s^2 at 120 fps.
TEST_F(FitTest, FeetLeaveTheFloorGentlyAtEveryRate) {
  const Clip clip = cut(recorded_clip("walk"), 60, 160);
  const Sole& sole = robot_->profile().soles.front();
  const auto walk = [&](double fps) {
    const auto at_rate = value_of(resample(clip, frame_rate_from_fps(fps), {}));
    const RobotClip motion = fitted(at_rate).clip;
    std::vector<Pose> bodies(robot_->bodies().size());
    std::vector<Eigen::Vector3d> steps;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (int t = 0; t < motion.frame_count(); ++t) {
      forward_kinematics(*robot_, motion.qpos(t), bodies);
      const Eigen::Vector3d now = bodies[static_cast<std::size_t>(sole.body)].translation;
      if (t > 0) steps.emplace_back(fps * (now - before));
      before = now;
    }
    double most = 0.0;
    for (std::size_t i = 1; i < steps.size(); ++i) {
      most = std::max(most, fps * (steps[i] - steps[i - 1]).norm());
    }
    return most;
  };
  EXPECT_LT(walk(30.0), 75.0);
  for (const double fps : {60.0, 100.0, 120.0}) EXPECT_LT(walk(fps), 210.0) << fps;
}

TEST_F(FitTest, HandlesRobotWithoutSolesAndShapes) {
  const auto bare = value_of(load_robot_files(RETARGET_SOURCE_DIR "/robots/unitree_g1/model.xml"));
  const Clip clip = cut(recorded_clip("walk"), 0, 10);
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  FitOptions options;
  options.iterations = 2;
  const auto result =
      value_of(fit(clip, calibration, bare, config_, bare->model_limits(), options));
  ASSERT_FALSE(result.report.notes.empty());
  EXPECT_THAT(result.report.notes.front(), HasSubstr("no soles"));
}

TEST_F(FitTest, UnusablePositionsAreAnErrorWithTheFrame) {
  Clip clip = cut(recorded_clip("walk"), 0, 20);
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  for (const double x : {1e150, std::numeric_limits<double>::quiet_NaN()}) {
    clip.translations(12)[0].x() = x;
    const auto result = fit(clip, calibration, robot_, config_, limits_);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().kind, ErrorKind::kInput);
    EXPECT_THAT(result.error().message, HasSubstr("frame 12"));
  }
}

TEST_F(FitTest, CanBeInterrupted) {
  const Clip clip = cut(recorded_clip("walk"), 0, 20);
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  FitRun run;
  run.keep_going = [](double) { return false; };
  const auto result = fit(clip, calibration, robot_, config_, limits_, {}, run);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::kInterrupted);
}

TEST_F(FitTest, CanBeInterruptedDuringTheFirstStage) {
  const Clip clip = cut(recorded_clip("walk"), 0, 100);
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  FitOptions options;
  options.window = 0.5;
  options.threads = 3;
  FitRun run;
  run.retarget.keep_going = [](int frame) { return frame < 80; };
  const auto result = fit(clip, calibration, robot_, config_, limits_, options, run);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace retarget
