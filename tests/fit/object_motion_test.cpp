// Objects that move with the hands that hold them, on a G1 that stands still.

#include "solve/fit/object_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "retarget/human.h"
#include "scene/scene_world.h"
#include "solve/targets/targets.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kFrameTime = 1.0 / 30.0;

// A crate between the hands of a G1, which touch its sides in some frames.
class ObjectMotionTest : public testing::Test {
 protected:
  void SetUp() override {
    robot_ = load_g1();
    const ResolvedConfig config = published_config(*robot_);
    const TargetBuilder targets(config, 1.75);
    BoneArray<int> target_of_bone;
    for (const Bone bone : kAllBones) target_of_bone[bone] = targets.target_of(bone);
    model_ = make_fit_model(*robot_, config, robot_->model_limits(), target_of_bone, {});
    for (std::size_t i = 0; i < model_.supports.size(); ++i) {
      const Bone bone = kSupportBones[model_.supports[i].support];
      if (bone == Bone::kLeftHand) left_ = static_cast<int>(i);
      if (bone == Bone::kRightHand) right_ = static_cast<int>(i);
    }
    ASSERT_GE(left_, 0);
    ASSERT_GE(right_, 0);
    pose_.emplace(model_.tree, robot_->zero_configuration());
    const Vector3d from = model_.supports[static_cast<std::size_t>(right_)].world_middle(*pose_);
    const Vector3d to = model_.supports[static_cast<std::size_t>(left_)].world_middle(*pose_);
    between_ = 0.5 * (from + to);
    width_ = (to - from).norm();
  }

  // @param path  of the crate. @param held  frames in which both hands hold it.
  FitScene scene_of(const std::vector<Vector3d>& path, std::pair<int, int> held) const {
    auto scene = std::make_shared<Scene>();
    SceneBody crate;
    crate.name = "crate";
    crate.moves = true;
    crate.shapes.emplace_back().half_size = Vector3d(0.2, 0.5 * width_ - 0.1, 0.1);
    scene->bodies.push_back(crate);
    SceneClip clip{scene, frame_rate_from_fps(30.0), static_cast<int>(path.size()), {}, {}};
    for (const Vector3d& position : path) {
      clip.world_from_body.emplace_back().translation = position;
    }
    FitScene fit;
    fit.world = make_scene_world(std::move(clip)).value();
    fit.first_goal.push_back(0);
    for (int t = 0; t < static_cast<int>(path.size()); ++t) {
      if (t >= held.first && t < held.second) {
        for (const int support : {left_, right_}) {
          SceneGoal goal{support, 0};
          const double side = support == left_ ? 1.0 : -1.0;
          goal.normal = side * Vector3d::UnitY();
          goal.place =
              path[static_cast<std::size_t>(t)] + side * (0.5 * width_ - 0.1) * goal.normal;
          goal.share = 1.0;
          fit.goals.push_back(goal);
        }
      }
      fit.first_goal.push_back(static_cast<std::uint32_t>(fit.goals.size()));
    }
    return fit;
  }

  std::vector<ObjectMove> follow(FitScene& scene) const {
    std::vector<double> qpos;
    for (int t = 0; t < scene.world.clip.frame_count; ++t) {
      const auto one = robot_->zero_configuration();
      qpos.insert(qpos.end(), one.begin(), one.end());
    }
    return follow_hands(model_, qpos, kFrameTime, scene);
  }

  // The distances of both hands from the crate.
  std::pair<double, double> gaps(const FitScene& scene, int frame) const {
    const auto of = [&](int support) {
      return model_.supports[static_cast<std::size_t>(support)]
          .nearest(*pose_, scene.world, frame, 0)
          .distance;
    };
    return {of(left_), of(right_)};
  }

  std::shared_ptr<const Robot> robot_;
  FitModel model_;
  std::optional<TreeState> pose_;
  int left_ = -1, right_ = -1;
  Vector3d between_;
  double width_ = 0.0;
};

TEST_F(ObjectMotionTest, CarriedCrateIsPlacedBetweenTheHands) {
  constexpr int kFrames = 60;
  const Vector3d aside(0.0, 0.06, 0.0);
  FitScene scene = scene_of(std::vector<Vector3d>(kFrames, between_ + aside), {0, kFrames});
  const auto before = gaps(scene, 30);
  EXPECT_GT(std::abs(before.first - before.second), 0.1);
  const std::vector<ObjectMove> moved = follow(scene);
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(moved[0].body, "crate");
  EXPECT_NEAR(moved[0].farthest, aside.y(), 0.005);
  for (const int frame : {0, 30, kFrames - 1}) {
    const auto after = gaps(scene, frame);
    EXPECT_NEAR(after.first, after.second, 0.005) << frame;
    EXPECT_NEAR(scene.world.clip.pose(frame, 0).translation.y(), between_.y(), 0.005);
  }
  // The goals have moved with it.
  EXPECT_NEAR(scene.goals_of(30)[0].place.y() - scene.world.clip.pose(30, 0).translation.y(),
              0.5 * width_ - 0.1, 1e-6);
}

// The crate lies on the floor, is lifted and held at an offset from the hands.
TEST_F(ObjectMotionTest, ACrateAtRestMovesOnlySmoothlyOnItsSupport) {
  constexpr int kFrames = 120;
  std::vector<Vector3d> path;
  for (int t = 0; t < kFrames; ++t) {
    const double up = std::clamp((t - 30.0) / 30.0, 0.0, 1.0);
    path.push_back(between_ + Vector3d(0.0, 0.05, 0.03));
    path.back().z() = 0.1 + up * (path.back().z() - 0.1);
  }
  FitScene scene = scene_of(path, {60, kFrames});
  ASSERT_EQ(follow(scene).size(), 1U);
  const auto& poses = scene.world.clip.world_from_body;
  for (int t = 0; t < 28; ++t) {
    EXPECT_NEAR(poses[static_cast<std::size_t>(t)].translation.z(), 0.1, 1e-12);
    EXPECT_EQ(poses[static_cast<std::size_t>(t)].translation, poses[0].translation);
    EXPECT_NEAR(poses[static_cast<std::size_t>(t)].rotation.x(), 0.0, 1e-12);
  }
  EXPECT_NEAR(poses.back().translation.y(), between_.y(), 0.005);
  for (std::size_t t = 1; t < poses.size(); ++t) {
    const Vector3d step = poses[t].translation - poses[t - 1].translation;
    const Vector3d given = path[t] - path[t - 1];
    EXPECT_LT((step - given).norm(), 0.012) << t;
  }
}

TEST_F(ObjectMotionTest, ObjectsThatAreNotHeldDoNotMove) {
  FitScene scene = scene_of(std::vector<Vector3d>(20, between_), {0, 0});
  EXPECT_TRUE(follow(scene).empty());
  EXPECT_EQ(scene.world.clip.pose(7, 0).translation, between_);
}

}  // namespace
}  // namespace retarget
