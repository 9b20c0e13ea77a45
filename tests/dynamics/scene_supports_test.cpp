// Scenes that support a robot and bodies that it carries, against closed forms.

#include "solve/dynamics/scene_supports.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "robot/shipped_robots.h"
#include "solve/dynamics/motion_dynamics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

SceneBody box(const Vector3d& size, const Vector3d& position) {
  SceneBody body;
  body.name = "box";
  body.shapes.emplace_back().half_size = 0.5 * size;
  body.world_from_body.translation = position;
  return body;
}

SceneWorld world_of(SceneBody body, const std::vector<Vector3d>& path, double fps = 30.0) {
  auto scene = std::make_shared<Scene>();
  scene->bodies.push_back(std::move(body));
  SceneClip clip{scene, frame_rate_from_fps(fps), static_cast<int>(path.size()), {}, {}};
  for (const Vector3d& position : path) {
    clip.world_from_body.emplace_back().translation = position;
  }
  return make_scene_world(std::move(clip)).value();
}

// The G1 in its zero configuration, with its soles at a height.
RobotClip standing_at(double height, int frames) {
  const auto robot = load_shipped("unitree_g1");
  RobotClip clip(robot, frame_rate_from_fps(30.0), frames);
  const TreeState state(robot->tree(), clip.qpos(0));
  double lowest = std::numeric_limits<double>::infinity();
  for (const SupportPoint& point : make_support_points(*robot)) {
    if (point.of_sole) lowest = std::min(lowest, lowest_of(point, state).z());
  }
  for (int t = 0; t < frames; ++t) clip.qpos(t)[2] += height - lowest;
  return clip;
}

TEST(SceneSupports, ABoxSupportsLikeTheFloor) {
  constexpr int kFrames = 10;
  const RobotClip high = standing_at(0.5, kFrames), low = standing_at(0.0, kFrames);
  const Vector3d middle(0.0, 0.0, 0.25);
  const SceneWorld world =
      world_of(box({2.0, 2.0, 0.5}, middle), std::vector<Vector3d>(kFrames, middle));
  const MotionDynamics without = analyse_dynamics(high), on_box = analyse_dynamics(high, &world),
                       on_floor = analyse_dynamics(low);
  for (std::size_t i = 0; i < on_box.samples.size(); ++i) {
    EXPECT_TRUE(without.samples[i].is_bad());
    EXPECT_TRUE(on_box.samples[i].supported);
    EXPECT_FALSE(on_box.samples[i].is_bad());
    EXPECT_NEAR(on_box.samples[i].torque_ratio, on_floor.samples[i].torque_ratio, 1e-6);
  }
}

TEST(SceneSupports, AnAscendingBodyWeighsMore) {
  constexpr double kMass = 4.0, kRise = 2.0;  // kg, m/s^2
  constexpr int kFrames = 31;
  SceneBody crate = box({0.3, 0.3, 0.3}, Vector3d::Zero());
  crate.moves = true;
  crate.mass = kMass;
  std::vector<Vector3d> path;
  for (int t = 0; t < kFrames; ++t) {
    path.emplace_back(0.0, 0.0, 1.0 + 0.5 * kRise * t * t / 900.0);
  }
  const SceneWorld world = world_of(crate, path);
  const SceneSupports supports(world, 0, kFrames);
  const auto robot = load_shipped("unitree_g1");
  TreeState state(robot->tree(), robot->zero_configuration());
  // Points of two links on the sides of the crate.
  const auto on = [&](int link, double x) {
    const Pose& pose = state.world_from_link[static_cast<std::size_t>(link)];
    return SupportPoint{link, pose.inverse() * Vector3d(x, 0.0, path[15].z()), 0.0, false};
  };
  std::vector<LinkLoad> loads;
  supports.find_loads(15, {on(3, 0.16), on(3, 0.17), on(5, -0.16), on(6, 0.3)}, state, 0.04, loads);
  ASSERT_EQ(loads.size(), 2U);
  for (const LinkLoad& load : loads) {
    const Vector3d expected(0.0, 0.0, 0.5 * kMass * (kGravity + kRise));
    EXPECT_LT((load.force - expected).norm(), 1e-9);
  }
  EXPECT_NEAR(loads[0].position.x(), 0.16, 1e-9) << "the nearest point of the link";
  EXPECT_NEAR(loads[1].position.x(), -0.16, 1e-9);
}

TEST(SceneSupports, ABodyOnTheFloorIsNotALoad) {
  constexpr int kFrames = 5;
  SceneBody crate = box({0.3, 0.3, 0.3}, Vector3d::Zero());
  crate.moves = true;
  const SceneWorld world =
      world_of(crate, std::vector<Vector3d>(kFrames, Vector3d(0.0, 0.0, 0.152)));
  const SceneSupports supports(world, 0, kFrames);
  const auto robot = load_shipped("unitree_g1");
  const TreeState state(robot->tree(), robot->zero_configuration());
  const Pose& pose = state.world_from_link[4];
  const Vector3d on_top(0.0, 0.0, 0.31);
  const SupportPoint point{4, pose.inverse() * on_top, 0.0, false};
  std::vector<LinkLoad> loads;
  supports.find_loads(2, {point}, state, 0.04, loads);
  EXPECT_TRUE(loads.empty());
  const auto touched = supports.touched(2, on_top, 0.0, Vector3d::Zero(), 0.02, 0.5).value();
  const ContactPlace place = supports.place(2, on_top, 0.0, touched);
  EXPECT_LT((place.normal - Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(place.position.z(), 0.31, 1e-9);
  EXPECT_FALSE(supports.touched(2, on_top, 0.0, Vector3d(1.0, 0.0, 0.0), 0.02, 0.5)) << "too fast";
}

TEST(SceneSupports, WorkWithFewFrames) {
  SceneBody crate = box({0.3, 0.3, 0.3}, Vector3d::Zero());
  crate.moves = true;
  for (const int frames : {1, 2, 3}) {
    const SceneWorld world =
        world_of(crate, std::vector<Vector3d>(static_cast<std::size_t>(frames), Vector3d(0, 0, 1)));
    const SceneSupports supports(world, 0, frames);
    const auto robot = load_shipped("unitree_g1");
    const TreeState state(robot->tree(), robot->zero_configuration());
    const SupportPoint point{0, state.world_from_link[0].inverse() * Vector3d(0.15, 0, 1), 0,
                             false};
    std::vector<LinkLoad> loads;
    supports.find_loads(frames + 5, {point}, state, 0.04, loads);
    ASSERT_EQ(loads.size(), 1U);
    EXPECT_GT(loads[0].force.z(), 0.0);
  }
}

}  // namespace
}  // namespace retarget
