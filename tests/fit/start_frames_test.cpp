// Start configurations above the floor and the surfaces of a scene.

#include "solve/fit/start_frames.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "fit/fit_model_test_base.h"
#include "scene/scene_world.h"
#include "solve/fit/fit_scene.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kTop = 0.3;  // Height of the box, metres.
constexpr std::size_t kSeat = 6;
static_assert(kSupportBones[kSeat] == Bone::kHips);

// A G1 in its zero configuration, one frame long, with a wide box below it.
class StartFramesTest : public FitModelTest {
 protected:
  void SetUp() override {
    FitModelTest::SetUp();
    qpos_ = robot_->zero_configuration();
    qpos_[2] = 0.0;
    qpos_[2] = -lowest_below_floor(model_, TreeState(model_.tree, qpos_));
    clip_.frame_count = 1;
    clip_.feet.foot_count = 2;
    clip_.feet.ends.assign(4, {});
    clip_.feet.upright.assign(2, 1.0);
    seat_ = std::ranges::find(model_.supports, kSeat, &SupportBody::support);
    ASSERT_NE(seat_, model_.supports.end());
  }

  void add_box() {
    auto scene = std::make_shared<Scene>();
    SceneBody& box = scene->bodies.emplace_back();
    box.name = "box";
    box.shapes.emplace_back().half_size = Vector3d(3.0, 3.0, 0.5 * kTop);
    box.world_from_body.translation.z() = 0.5 * kTop;
    SceneClip placed{scene, frame_rate_from_fps(30.0), 1, {box.world_from_body}};
    scene_ = std::make_shared<FitScene>();
    scene_->world = make_scene_world(std::move(placed)).value();
    scene_->first_goal = {0, 0};
    clip_.scene = scene_;
  }

  void touch_with_seat(const Vector3d& normal) {
    SceneGoal goal{static_cast<int>(seat_ - model_.supports.begin()), 0};
    goal.normal = normal;
    goal.share = 1.0;
    scene_->goals = {goal};
    scene_->first_goal = {0, 1};
  }

  // By how much the root rises, metres.
  double rise() {
    const std::array path = {Vector3d(0.0, 0.0, 0.0)};
    StartFrames starts(model_, path, true, clip_);
    starts.take(0, qpos_);
    return clip_.frame(0, model_.configuration_size)[2] - qpos_[2];
  }

  std::vector<double> qpos_;
  FitClip clip_;
  std::shared_ptr<FitScene> scene_;
  std::vector<SupportBody>::const_iterator seat_;
};

TEST_F(StartFramesTest, RiseToTheFloor) {
  qpos_[2] -= 0.02;
  EXPECT_NEAR(rise(), 0.02, 1e-9);
}

TEST_F(StartFramesTest, FeetRiseToTheGroundOfTheHuman) {
  add_box();
  for (FootEndGoal& end : clip_.feet.ends) end.support = kTop;
  EXPECT_NEAR(rise(), kTop, 1e-3);
}

// The toes of a robot with longer feet reach into a step on which the human does not stand.
TEST_F(StartFramesTest, FeetDoNotRiseToOtherSurfaces) {
  add_box();
  EXPECT_NEAR(rise(), 0.0, 1e-9);
}

TEST_F(StartFramesTest, PartsInContactRiseToTheTopOfTheirBody) {
  add_box();
  TreeState pose(model_.tree, qpos_);
  const double depth = 0.05;
  qpos_[2] -= seat_->lowest(pose).height - (kTop - depth);
  // Only the seat counts: the legs would be below the floor.
  model_.floor_points.assign(model_.floor_points.size(), {});
  for (FitFoot& foot : model_.feet) {
    for (FitFoot::End& end : foot.ends) end.points.clear();
  }
  EXPECT_NEAR(rise(), 0.0, 1e-9);
  touch_with_seat(Vector3d::UnitX());
  EXPECT_NEAR(rise(), 0.0, 1e-9) << "a wall does not carry";
  touch_with_seat(Vector3d::UnitZ());
  EXPECT_NEAR(rise(), depth, 1e-6);
}

}  // namespace
}  // namespace retarget
