// Limbs that pass through each other between two frames.

#include "solve/fit/crossing_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fit/fit_model_test_base.h"
#include "solve/fit/half_way.h"

namespace retarget {
namespace {

constexpr int kCrossingFrames = 90, kPassing = 45;

class CrossingFramesTest : public FitModelTest {
 protected:
  void SetUp() override {
    FitModelTest::SetUp();
    options_.dynamics = false;
    options_.floor = false;
  }

  void set(std::vector<double>& qpos, const std::string& joint, double value) const {
    for (const auto& link : model_.tree.links()) {
      if (link.joint >= 0 && robot_->joints()[static_cast<std::size_t>(link.joint)].name == joint) {
        qpos[static_cast<std::size_t>(link.qpos_address)] = value;
      }
    }
  }

  // The left hand is above the right one until frame kPassing, and below it afterwards.
  void make_clip() {
    for (int frame = 0; frame < kCrossingFrames; ++frame) {
      std::vector<double> qpos = robot_->zero_configuration();
      set(qpos, "right_shoulder_pitch_joint", -0.6);
      set(qpos, "left_shoulder_pitch_joint", -0.6);
      set(qpos, "right_shoulder_yaw_joint", 0.4);
      set(qpos, "left_shoulder_yaw_joint", -0.4);
      set(qpos, "left_elbow_joint", frame < kPassing ? -0.4 : 0.4);
      add(qpos);
    }
  }
  void add(const std::vector<double>& qpos) {
    const TreeState pose(model_.tree, qpos);
    clip_.qpos.insert(clip_.qpos.end(), qpos.begin(), qpos.end());
    for (const FitTask& task : model_.tasks) {
      const Pose& link = pose.world_from_link[static_cast<std::size_t>(task.link)];
      clip_.targets.push_back({link * task.position, link.rotation});
    }
    clip_.frame_count += 1;
    const auto frames = static_cast<std::size_t>(clip_.frame_count);
    clip_.feet.foot_count = static_cast<int>(model_.feet.size());
    clip_.feet.ends.resize(2 * model_.feet.size() * frames);
    clip_.feet.upright.resize(model_.feet.size() * frames, 1.0);
    clip_.feet.support_count = static_cast<int>(model_.supports.size());
    clip_.feet.supports.resize(model_.supports.size() * frames);
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
    for (int frame = 1; frame < kCrossingFrames; ++frame) {
      deepest = std::max({deepest, depth(frame - 1, frame), depth(frame, frame)});
    }
    return deepest;
  }

  FitClip clip_;
};

TEST_F(CrossingFramesTest, AreSolvedAgain) {
  make_clip();
  ASSERT_GT(depth(kPassing - 1, kPassing), 0.04);
  ASSERT_LT(depth(kPassing, kPassing), 0.001);
  const std::vector<double> before = clip_.qpos;
  BranchRecovery result;
  solve_crossing_frames(model_, options_, clip_, {}, result);
  EXPECT_LT(deepest(), 0.02);
  EXPECT_FALSE(result.stopped);
  EXPECT_TRUE(result.failures.empty());
  // The window extends by less than a second.
  const auto size = static_cast<std::ptrdiff_t>(model_.configuration_size);
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + 10 * size, clip_.qpos.begin()));
  EXPECT_TRUE(std::equal(before.end() - 10 * size, before.end(), clip_.qpos.end() - 10 * size));
}

TEST_F(CrossingFramesTest, StayUnchangedWithoutSelfCollision) {
  options_.self_collision = false;
  make_clip();
  const std::vector<double> before = clip_.qpos;
  BranchRecovery result;
  solve_crossing_frames(model_, options_, clip_, {}, result);
  EXPECT_EQ(clip_.qpos, before);
}

TEST_F(CrossingFramesTest, StayUnchangedIfTheCallerStops) {
  make_clip();
  const std::vector<double> before = clip_.qpos;
  BranchRecovery result;
  solve_crossing_frames(
      model_, options_, clip_, [] { return false; }, result);
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(clip_.qpos, before);
}

// Opposite signs describe the same rotation.
TEST_F(CrossingFramesTest, SignsOfQuaternionsAreArbitrary) {
  make_clip();
  const double before = depth(kPassing - 1, kPassing);
  for (std::size_t k = 3; k < 7; ++k) {
    double& part = clip_.frame(kPassing, model_.configuration_size)[k];
    part = -part;
  }
  EXPECT_EQ(depth(kPassing - 1, kPassing), before);
}

}  // namespace
}  // namespace retarget
