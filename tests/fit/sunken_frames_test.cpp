// Frames below the floor: a standing G1 that is lowered for a third of a second.

#include "solve/fit/sunken_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "fit/fit_model_test_base.h"
#include "solve/fit/start_frames.h"

namespace retarget {
namespace {

constexpr int kFrames = 90, kBegin = 40, kEnd = 50;

class SunkenFramesTest : public FitModelTest {
 protected:
  void SetUp() override {
    FitModelTest::SetUp();
    options_.dynamics = false;
  }

  // @param depth  by which frames [kBegin, kEnd) are below their targets, metres.
  void make_clip(double depth) {
    std::vector<double> qpos = robot_->zero_configuration();
    TreeState pose(model_.tree);
    qpos[2] = 0.0;
    pose.update(qpos);
    qpos[2] = -lowest_below_floor(model_, pose);
    pose.update(qpos);
    for (int frame = 0; frame < kFrames; ++frame) {
      clip_.qpos.insert(clip_.qpos.end(), qpos.begin(), qpos.end());
      if (frame >= kBegin && frame < kEnd) {
        clip_.qpos[clip_.qpos.size() - qpos.size() + 2] -= depth;
      }
      for (const FitTask& task : model_.tasks) {
        const Pose& link = pose.world_from_link[static_cast<std::size_t>(task.link)];
        clip_.targets.push_back({link * task.position, link.rotation});
      }
    }
    clip_.frame_count = kFrames;
    const auto frames = static_cast<std::size_t>(kFrames);
    clip_.feet.foot_count = static_cast<int>(model_.feet.size());
    clip_.feet.ends.resize(2 * model_.feet.size() * frames);
    clip_.feet.upright.resize(model_.feet.size() * frames, 1.0);
    clip_.feet.support_count = static_cast<int>(model_.supports.size());
    clip_.feet.supports.resize(model_.supports.size() * frames);
  }

  BranchRecovery solve() {
    BranchRecovery result;
    solve_sunken_frames(model_, options_, clip_, {}, result);
    return result;
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

  FitClip clip_;
};

TEST_F(SunkenFramesTest, AreSolvedAgain) {
  make_clip(0.03);
  ASSERT_NEAR(deepest(), 0.03, 1e-9);
  const std::vector<double> before = clip_.qpos;
  const BranchRecovery result = solve();
  EXPECT_LT(deepest(), 0.005);
  EXPECT_FALSE(result.stopped);
  EXPECT_TRUE(result.limbs.empty());
  EXPECT_TRUE(result.failures.empty());
  // The window extends by less than a second.
  const auto size = static_cast<std::ptrdiff_t>(model_.configuration_size);
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + 10 * size, clip_.qpos.begin()));
  EXPECT_TRUE(std::equal(before.end() - 10 * size, before.end(), clip_.qpos.end() - 10 * size));
}

TEST_F(SunkenFramesTest, ThatAreShallowStayUnchanged) {
  make_clip(0.009);
  const std::vector<double> before = clip_.qpos;
  solve();
  EXPECT_EQ(clip_.qpos, before);
}

TEST_F(SunkenFramesTest, StayUnchangedWithoutFloor) {
  options_.floor = false;
  make_clip(0.03);
  const std::vector<double> before = clip_.qpos;
  solve();
  EXPECT_EQ(clip_.qpos, before);
}

TEST_F(SunkenFramesTest, StayUnchangedIfTheCallerStops) {
  make_clip(0.03);
  const std::vector<double> before = clip_.qpos;
  BranchRecovery result;
  solve_sunken_frames(
      model_, options_, clip_, [] { return false; }, result);
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(clip_.qpos, before);
}

}  // namespace
}  // namespace retarget
