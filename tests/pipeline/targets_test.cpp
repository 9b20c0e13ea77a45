#include "solve/targets/targets.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/test_robots.h"

namespace retarget {
namespace {

IkMatch row(const std::string& body, const std::string& bone, Eigen::Vector3d offset,
            Eigen::Quaterniond turn) {
  IkMatch result;
  result.body = body;
  result.bone = bone;
  result.position_weight = 1.0;
  result.rotation_weight = 2.0;
  result.position_offset = offset;
  result.rotation_offset = turn;
  return result;
}

RetargetingConfig small_tables() {
  RetargetingConfig config;
  config.robot_root = "base";
  config.human_root = "Hips";
  config.ground_height = 0.25;
  config.human_height_assumption = 2.0;
  config.scales = {{"Hips", 0.8}, {"LeftArm", 0.6}, {"RightArm", 0.4}};
  const double half = std::sqrt(0.5);
  config.match_tables[0].rows = {
      row("left_upper", "LeftArm", {0.1, 0, 0}, Eigen::Quaterniond(half, 0, 0, half)),
      row("base", "Hips", {0, 0, 0}, Eigen::Quaterniond::Identity())};
  // Other offsets for a bone of table 1, which must be ignored, and a bone only in table 2, whose
  // offsets apply.
  config.match_tables[1].rows = {
      row("left_upper", "LeftArm", {9, 9, 9}, Eigen::Quaterniond::Identity()),
      row("right_upper", "RightArm", {0, 0.5, 0}, Eigen::Quaterniond::Identity())};
  return config;
}

TEST(TargetBuilder, ScalesAboutTheRootAndAppliesOffsets) {
  const auto robot = robot_from_text(kTwoArms);
  const TargetBuilder builder(resolve_config(small_tables(), *robot).value(), 1.0);
  HumanPose bones;
  const Bone hips = Bone::kHips, left = Bone::kLeftArm, right = Bone::kRightArm;
  bones[hips].translation = {1, 2, 3};
  bones[left].translation = {2, 2, 4};
  bones[left].rotation = Eigen::Quaterniond(0, 1, 0, 0);  // half a turn about x
  bones[right].translation = {1, 0, 3};
  ASSERT_EQ(builder.target_count(), 3);
  EXPECT_EQ(builder.bones(), (std::vector<Bone>{hips, left, right}));
  std::vector<Pose> targets(3);
  builder.build(bones, targets);

  // Scales are halved: the body is 1 m high instead of the assumed 2 m.
  const Eigen::Vector3d root(0.4, 0.8, 1.2);
  const Pose& hips_target = targets[builder.target_of(hips)];
  EXPECT_LT((hips_target.translation - (root + Eigen::Vector3d(0, 0, -0.25))).norm(), 1e-15);
  // Offset and ground are in the target's frame: half a turn about x, then a quarter about z.
  const Pose& left_target = targets[builder.target_of(left)];
  const Eigen::Vector3d scaled = root + 0.3 * Eigen::Vector3d(1, 0, 1);
  EXPECT_LT((left_target.translation - (scaled + Eigen::Vector3d(0, -0.1, 0.25))).norm(), 1e-15);
  const Pose& right_target = targets[builder.target_of(right)];
  EXPECT_LT((right_target.translation - (root + Eigen::Vector3d(0, -0.4 + 0.5, -0.25))).norm(),
            1e-15);
}

TEST(MakeProblem, OmitsUnusedTablesAndRowsWithoutWeight) {
  const auto robot = robot_from_text(kTwoArms);
  ResolvedConfig config = resolve_config(small_tables(), *robot).value();
  ConfigTask& first = config.match_tables[0].tasks[0];
  first.position_weight = first.rotation_weight = 0.0;
  const auto problem =
      make_problem(robot, config, TargetBuilder(config, 1.0), robot->model_limits());
  ASSERT_EQ(problem->passes.size(), 2u);
  ASSERT_EQ(problem->passes[0].size(), 1u);
  const FrameTask& task = problem->passes[0][0];
  EXPECT_EQ(task.body, *robot->find_body("base"));
  EXPECT_EQ(task.target, 0);
  EXPECT_EQ(task.position_weight, 1.0);
  EXPECT_EQ(task.rotation_weight, 2.0);
  EXPECT_EQ(problem->lower[0], -1.0);
  config.match_tables[0].used = false;
  const auto second =
      make_problem(robot, config, TargetBuilder(config, 1.0), robot->model_limits());
  EXPECT_EQ(second->passes.size(), 1u);
}

}  // namespace
}  // namespace retarget
