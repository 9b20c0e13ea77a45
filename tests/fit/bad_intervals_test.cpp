// Intervals that are solved again: points below the floor, and limbs that pass through each other
// between two frames.

#include "solve/fit/bad_intervals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fit/fit_model_test_base.h"
#include "solve/fit/half_way.h"
#include "solve/fit/start_frames.h"

namespace retarget {
namespace {

constexpr int kFrames = 90;

class BadIntervalsTest : public FitModelTest {
 protected:
  void SetUp() override {
    FitModelTest::SetUp();
    options_.dynamics = false;
  }

  void add(const std::vector<double>& qpos, const TreeState& target) {
    clip_.qpos.insert(clip_.qpos.end(), qpos.begin(), qpos.end());
    for (const FitTask& task : model_.tasks) {
      const Pose& link = target.world_from_link[static_cast<std::size_t>(task.link)];
      clip_.targets.push_back({link * task.position, link.rotation});
    }
    const auto frames = static_cast<std::size_t>(++clip_.frame_count);
    clip_.feet.foot_count = static_cast<int>(model_.feet.size());
    clip_.feet.ends.resize(2 * model_.feet.size() * frames);
    clip_.feet.upright.resize(model_.feet.size() * frames, 1.0);
    clip_.feet.support_count = static_cast<int>(model_.supports.size());
    clip_.feet.supports.resize(model_.supports.size() * frames);
  }

  using Solve = decltype(solve_sunken_frames);

  // Solves a window, which extends the interval by less than a second.
  void solve_window(Solve& solve) {
    const std::vector<double> before = clip_.qpos;
    BranchRecovery result;
    solve(model_, options_, clip_, {}, result);
    EXPECT_FALSE(result.stopped);
    EXPECT_TRUE(result.limbs.empty());
    EXPECT_TRUE(result.failures.empty());
    const auto size = static_cast<std::ptrdiff_t>(model_.configuration_size);
    EXPECT_TRUE(std::equal(before.begin(), before.begin() + 10 * size, clip_.qpos.begin()));
    EXPECT_TRUE(std::equal(before.end() - 10 * size, before.end(), clip_.qpos.end() - 10 * size));
  }
  void expect_unchanged(Solve& solve) {
    const std::vector<double> before = clip_.qpos;
    BranchRecovery result;
    solve(model_, options_, clip_, {}, result);
    EXPECT_EQ(clip_.qpos, before);
  }
  void expect_unchanged_if_stopped(Solve& solve) {
    const std::vector<double> before = clip_.qpos;
    BranchRecovery result;
    solve(
        model_, options_, clip_, [] { return false; }, result);
    EXPECT_TRUE(result.stopped);
    EXPECT_EQ(clip_.qpos, before);
  }

  FitClip clip_;
};

// A standing G1 that is lowered for a third of a second.
class SunkenFramesTest : public BadIntervalsTest {
 protected:
  // @param depth  by which ten frames are below their targets, metres.
  void make_clip(double depth) {
    std::vector<double> qpos = robot_->zero_configuration();
    TreeState pose(model_.tree);
    qpos[2] = 0.0;
    pose.update(qpos);
    qpos[2] = -lowest_below_floor(model_, pose);
    pose.update(qpos);
    for (int frame = 0; frame < kFrames; ++frame) {
      std::vector<double> lowered = qpos;
      if (frame >= 40 && frame < 50) lowered[2] -= depth;
      add(lowered, pose);
    }
  }

  [[nodiscard]] double deepest() const {
    TreeState pose(model_.tree);
    double deepest = 0.0;
    for (int frame = 0; frame < kFrames; ++frame) {
      pose.update(clip_.frame(frame, model_.configuration_size));
      deepest = std::max(deepest, -lowest_below_floor(model_, pose));
    }
    return deepest;
  }
};

TEST_F(SunkenFramesTest, AreSolvedAgain) {
  make_clip(0.03);
  ASSERT_NEAR(deepest(), 0.03, 1e-9);
  solve_window(solve_sunken_frames);
  EXPECT_LT(deepest(), 0.005);
}

TEST_F(SunkenFramesTest, ThatAreShallowStayUnchanged) {
  make_clip(0.009);
  expect_unchanged(solve_sunken_frames);
}

TEST_F(SunkenFramesTest, StayUnchangedWithoutFloor) {
  options_.floor = false;
  make_clip(0.03);
  expect_unchanged(solve_sunken_frames);
}

TEST_F(SunkenFramesTest, StayUnchangedIfTheCallerStops) {
  make_clip(0.03);
  expect_unchanged_if_stopped(solve_sunken_frames);
}

// The left hand is above the right one until frame kPassing, and below it afterwards.
class CrossingFramesTest : public BadIntervalsTest {
 protected:
  static constexpr int kPassing = 45;

  void SetUp() override {
    BadIntervalsTest::SetUp();
    options_.floor = false;
    for (int frame = 0; frame < kFrames; ++frame) {
      std::vector<double> qpos = robot_->zero_configuration();
      set(qpos, "right_shoulder_pitch_joint", -0.6);
      set(qpos, "left_shoulder_pitch_joint", -0.6);
      set(qpos, "right_shoulder_yaw_joint", 0.4);
      set(qpos, "left_shoulder_yaw_joint", -0.4);
      set(qpos, "left_elbow_joint", frame < kPassing ? -0.4 : 0.4);
      add(qpos, TreeState(model_.tree, qpos));
    }
  }

  void set(std::vector<double>& qpos, const std::string& joint, double value) const {
    for (const auto& link : model_.tree.links()) {
      if (link.joint >= 0 && robot_->joints()[static_cast<std::size_t>(link.joint)].name == joint) {
        qpos[static_cast<std::size_t>(link.qpos_address)] = value;
      }
    }
  }

  // Depth of the deepest overlap half-way between two frames; in a frame if they are equal.
  [[nodiscard]] double depth(int from, int to) const {
    HalfWay half_way(model_);
    half_way.update(clip_.frame(from, model_.configuration_size),
                    clip_.frame(to, model_.configuration_size));
    double depth = 0.0;
    for (std::uint32_t pair = 0; pair < model_.pairs.size(); ++pair) {
      depth = std::max(depth, -pair_distance(model_, half_way.pose(), pair));
    }
    return depth;
  }
  [[nodiscard]] double deepest() const {
    double deepest = depth(0, 0);
    for (int frame = 1; frame < kFrames; ++frame) {
      deepest = std::max({deepest, depth(frame - 1, frame), depth(frame, frame)});
    }
    return deepest;
  }
};

TEST_F(CrossingFramesTest, AreSolvedAgain) {
  ASSERT_GT(depth(kPassing - 1, kPassing), 0.04);
  ASSERT_LT(depth(kPassing, kPassing), 0.001);
  solve_window(solve_crossing_frames);
  EXPECT_LT(deepest(), 0.02);
}

TEST_F(CrossingFramesTest, StayUnchangedWithoutSelfCollision) {
  options_.self_collision = false;
  expect_unchanged(solve_crossing_frames);
}

TEST_F(CrossingFramesTest, StayUnchangedIfTheCallerStops) {
  expect_unchanged_if_stopped(solve_crossing_frames);
}

// Opposite signs describe the same rotation.
TEST_F(CrossingFramesTest, SignsOfQuaternionsAreArbitrary) {
  const double before = depth(kPassing - 1, kPassing);
  for (std::size_t k = 3; k < 7; ++k) {
    double& part = clip_.frame(kPassing, model_.configuration_size)[k];
    part = -part;
  }
  EXPECT_EQ(depth(kPassing - 1, kPassing), before);
}

}  // namespace
}  // namespace retarget
