#include "solve/fit/task_terms.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <vector>

#include "fit/fit_model_test_base.h"
#include "retarget/so3.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

TEST(RotationTerm, WeightsTwistAndDirectionSeparately) {
  FitTask task;
  task.rotation_weight = 14.0;
  task.twist_weight = 6.0;
  task.twist_axis = Vector3d(0.6, 0.0, 0.8);
  const TaskTarget target{Vector3d::Zero(), exp_so3(Vector3d(0.3, -0.2, 0.5))};
  const auto cost_of_turn = [&](const Vector3d& in_link) {
    const Pose world{target.world_from_link * exp_so3(in_link), Vector3d::Zero()};
    return rotation_term(task, {}, world, target).cost;
  };
  EXPECT_NEAR(cost_of_turn(0.2 * task.twist_axis), square(6.0 * 0.2), 1e-9);
  EXPECT_NEAR(cost_of_turn(0.2 * Vector3d::UnitY()), square(14.0 * 0.2), 1e-9);
}

TEST(RotationTerm, TargetsScaleTheWeightOfTheTwistOnly) {
  FitTask task;
  task.rotation_weight = task.twist_weight = 48.0;
  TaskTarget target;
  const auto cost_of_turn = [&](const Vector3d& in_link) {
    return rotation_term(task, {}, {exp_so3(in_link), Vector3d::Zero()}, target).cost;
  };
  for (const double share : {1.0, 0.5, 0.0}) {
    target.twist_share = share;
    EXPECT_NEAR(cost_of_turn(0.2 * task.twist_axis), square(share * 48.0 * 0.2), 1e-9) << share;
    EXPECT_NEAR(cost_of_turn(0.2 * Vector3d::UnitY()), square(48.0 * 0.2), 1e-9) << share;
  }
}

// A twist by a small angle moves the other bone of the arm by the sine of the elbow's bend.
TEST_F(FitModelTest, TwistOfAnArmCountsByTheBendOfTheElbow) {
  const auto share_of = [&](Bone bone, double bend) {
    std::vector<Pose> world_from_target(kBoneCount);
    for (const FitTask& task : model_.tasks) {
      const double turn = task.bone == Bone::kLeftForeArm ? bend : 0.0;
      world_from_target[static_cast<std::size_t>(task.target)].rotation.setFromTwoVectors(
          task.link_from_body.conjugate() * task.twist_axis,
          Vector3d(std::cos(turn), std::sin(turn), 0.0));
    }
    std::vector<TaskTarget> targets(1);
    append_targets(model_, world_from_target, Vector3d::Zero(), targets);
    EXPECT_EQ(targets.size(), 1 + model_.tasks.size());
    for (std::size_t k = 0; k < model_.tasks.size(); ++k) {
      if (model_.tasks[k].bone == bone) return targets[1 + k].twist_share;
    }
    ADD_FAILURE();
    return 0.0;
  };
  EXPECT_NEAR(share_of(Bone::kLeftArm, 0.0), 0.2, 1e-9);
  EXPECT_NEAR(share_of(Bone::kLeftArm, std::numbers::pi / 6.0), std::sqrt(0.25 + 0.75 * 0.04),
              1e-9);
  EXPECT_NEAR(share_of(Bone::kLeftArm, 1.6), 1.0, 1e-3);
  EXPECT_NEAR(share_of(Bone::kLeftArm, 2.5), 1.0, 1e-9);
  EXPECT_EQ(share_of(Bone::kLeftForeArm, 0.0), 1.0);
  EXPECT_NEAR(share_of(Bone::kRightArm, 1.6), 0.2, 1e-9);
  EXPECT_EQ(share_of(Bone::kLeftUpLeg, 0.0), 1.0);
}

TEST(RotationTerm, GradientIsExactAndHessianPositiveForLargeErrors) {
  FitTask task;
  task.rotation_weight = 35.0;
  task.twist_weight = 6.0;
  task.twist_axis = Vector3d::UnitX();
  const TaskTarget target;
  constexpr double kStep = 1e-6;
  for (const double angle : {0.1, 0.5, 1.0, 2.0, 2.5}) {
    for (const Vector3d& about : {Vector3d(0.0, 1.0, 0.0), Vector3d(0.48, 0.6, 0.64)}) {
      const auto term_at = [&](const Vector3d& moved) {
        const Pose world{exp_so3(moved) * exp_so3(angle * about), Vector3d::Zero()};
        return rotation_term(task, {}, world, target);
      };
      const RotationTerm term = term_at(Vector3d::Zero());
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d step = kStep * Vector3d::Unit(axis);
        const double rate = 0.25 * (term_at(step).cost - term_at(-step).cost) / kStep;
        // The series of the derivative is accurate to the sixth order.
        EXPECT_NEAR(term.gradient[axis], rate,
                    0.02 * square(35.0) * std::pow(angle / 2.5, 7.0) + 1e-3)
            << angle;
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(term.hessian);
      EXPECT_GE(solver.eigenvalues()[0], square(6.0) - 1e-9) << angle;
    }
  }
}

}  // namespace
}  // namespace retarget
