#include "solve/targets/frame_solver.h"

#include <gtest/gtest.h>

#include "retarget/human.h"
#include "retarget/so3.h"
#include "support/angles.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

TEST(ArmRecovery, AreDetectedFromSixtyDegreesWithBackoff) {
  const auto robot = load_g1();
  const ResolvedConfig config =
      load_config(RETARGET_SOURCE_DIR "/robots/unitree_g1/ik.json", *robot).value();
  const TargetBuilder targets(config, 1.75);
  const auto problem = make_problem(robot, config, targets, robot->model_limits());
  const std::vector<double> qpos = robot->zero_configuration();
  std::vector<Pose> world_from_body(robot->bodies().size());
  forward_kinematics(*robot, qpos, world_from_body);
  // All bodies are on their targets except for one arm.
  std::vector<Pose> world_from_target(static_cast<std::size_t>(targets.target_count()));
  const auto turn = [&](double degrees) {
    for (const FrameTask& task : problem->passes.back()) {
      world_from_target[static_cast<std::size_t>(task.target)] =
          world_from_body[static_cast<std::size_t>(task.body)];
    }
    Pose& arm = world_from_target[static_cast<std::size_t>(targets.target_of(Bone::kRightArm))];
    arm.rotation = arm.rotation * exp_so3({0.0, degrees * kDegree, 0.0});
  };
  ArmRecovery arms(*problem, targets);
  turn(59.0);
  EXPECT_FALSE(arms.seen(qpos, world_from_target));
  turn(61.0);
  const auto frames_until_seen = [&] {
    for (int frame = 1; frame < 100; ++frame) {
      if (arms.seen(qpos, world_from_target)) return frame;
    }
    return -1;
  };
  EXPECT_EQ(frames_until_seen(), 1);
  EXPECT_EQ(frames_until_seen(), 5);
  EXPECT_EQ(frames_until_seen(), 9);
  EXPECT_EQ(frames_until_seen(), 17);
  // The arm returns, and goes astray again.
  turn(0.0);
  EXPECT_EQ(frames_until_seen(), -1);
  turn(120.0);
  EXPECT_EQ(frames_until_seen(), 1);
}

}  // namespace
}  // namespace retarget
