#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "base/math/se3.h"
#include "ik/ik_cases.h"
#include "solve/ik/box_qp.h"
#include "solve/ik/ik_solver.h"

namespace retarget {
namespace {

std::shared_ptr<IkProblem> make_problem(std::shared_ptr<const Robot> robot) {
  auto problem = std::make_shared<IkProblem>();
  const LimitSet& limits = robot->model_limits();
  problem->lower = Eigen::Map<const Eigen::VectorXd>(limits.lower.data(), limits.lower.size());
  problem->upper = Eigen::Map<const Eigen::VectorXd>(limits.upper.data(), limits.upper.size());
  problem->robot = std::move(robot);
  return problem;
}

// Gradient of 1/2 sum |W e|^2 at a configuration, by central differences along each velocity.
Eigen::VectorXd numeric_gradient(const Robot& robot, const IkPass& tasks,
                                 const std::vector<Pose>& targets,
                                 const std::vector<double>& qpos) {
  const auto cost = [&](const std::vector<double>& q) {
    std::vector<Pose> world_from_body(robot.bodies().size());
    forward_kinematics(robot, q, world_from_body);
    double sum = 0.0;
    for (const FrameTask& task : tasks) {
      const Vector6d e = log_se3(world_from_body[task.body].inverse() * targets[task.target]);
      sum += 0.5 * std::pow(task.position_weight, 2) * e.head<3>().squaredNorm() +
             0.5 * std::pow(task.rotation_weight, 2) * e.tail<3>().squaredNorm();
    }
    return sum;
  };
  constexpr double kStep = 1e-6;
  Eigen::VectorXd gradient(robot.model()->nv);
  for (int i = 0; i < gradient.size(); ++i) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(gradient.size());
    v[i] = kStep;
    std::vector<double> ahead = qpos, behind = qpos;
    mj_integratePos(robot.model(), ahead.data(), v.data(), 1.0);
    mj_integratePos(robot.model(), behind.data(), v.data(), -1.0);
    gradient[i] = (cost(ahead) - cost(behind)) / (2.0 * kStep);
  }
  return gradient;
}

TEST(ReferenceSolver, LinearTermIsTheGradient) {
  const auto robot = robot_from_text(kTwoArms);
  auto problem = make_problem(robot);
  problem->passes = {{{robot->find_body("base").value(), 0, 3.0, 1.0},
                      {robot->find_body("left_lower").value(), 1, 5.0, 0.0},
                      {robot->find_body("right_upper").value(), 2, 0.0, 2.0}}};
  std::mt19937 engine(11);
  const std::vector<double> start = random_configuration(*robot, engine, 0.5);
  const std::vector<double> goal = random_configuration(*robot, engine, 0.5);
  std::vector<Pose> bodies(robot->bodies().size());
  forward_kinematics(*robot, goal, bodies);
  const std::vector<Pose> targets = {bodies[1], bodies[robot->find_body("left_lower").value()],
                                     bodies[robot->find_body("right_upper").value()]};

  Eigen::VectorXd linear;
  const auto record = [&](const QpRecord& qp) {
    if (linear.size() == 0) linear = qp.g;
  };
  const auto solver = make_reference_solver(problem, {}, record);
  std::vector<double> qpos = start;
  solver->solve_pass(0, targets, qpos);
  const Eigen::VectorXd expected = numeric_gradient(*robot, problem->passes[0], targets, start);
  EXPECT_LT((linear - expected).norm(), 1e-6 * (1.0 + expected.norm()));
}

TEST(ReferenceSolver, ReachesReachableTargets) {
  const auto robot = load_g1();
  auto problem = make_problem(robot);
  IkPass pass;
  std::vector<Pose> targets;
  std::mt19937 engine(5);
  const std::vector<double> goal = random_configuration(*robot, engine, 0.5);
  std::vector<Pose> bodies(robot->bodies().size());
  forward_kinematics(*robot, goal, bodies);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    pass.push_back({static_cast<int>(b), static_cast<int>(targets.size()), 10.0, 10.0});
    targets.push_back(bodies[b]);
  }
  problem->passes = {pass};
  IkOptions options;
  options.max_extra_steps = kMaxExtraSteps;
  options.min_progress = -1.0;  // Take all steps, even if the error rises.
  const auto solver = make_reference_solver(problem, options);
  std::vector<double> qpos = robot->zero_configuration();
  PassResult result;
  for (int repeat = 0; repeat < 5; ++repeat) result = solver->solve_pass(0, targets, qpos);
  EXPECT_LT(result.errors[result.steps], 1e-6);
  for (const RobotJoint& joint : robot->joints()) {
    EXPECT_NEAR(qpos[joint.qpos_address], goal[joint.qpos_address], 1e-6) << joint.name;
  }
}

TEST(ReferenceSolver, StaysInsideTheLimits) {
  const auto robot = load_g1();
  auto problem = make_problem(robot);
  const int hand = robot->find_body("left_wrist_yaw_link").value();
  const int foot = robot->find_body("right_ankle_roll_link").value();
  problem->passes = {{{hand, 0, 100.0, 1.0}, {foot, 1, 100.0, 1.0}}};
  const auto solver = make_reference_solver(problem, {});
  std::vector<double> qpos = robot->zero_configuration();
  // Out of reach, behind the back.
  const std::vector<Pose> targets = {{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {-3.0, -2.0, 3.0}},
                                     {Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0), {3.0, 2.0, 3.0}}};
  for (int repeat = 0; repeat < 30; ++repeat) {
    ASSERT_TRUE(solver->solve_pass(0, targets, qpos).converged);
    for (std::size_t j = 0; j < robot->joints().size(); ++j) {
      const double q = qpos[robot->joints()[j].qpos_address];
      ASSERT_GE(q, problem->lower[j] - 1e-12) << robot->joints()[j].name;
      ASSERT_LE(q, problem->upper[j] + 1e-12) << robot->joints()[j].name;
    }
  }
}

TEST(ReferenceSolver, StopsWhenTheErrorStopsFalling) {
  const auto robot = robot_from_text(kTwoArms);
  auto problem = make_problem(robot);
  problem->passes = {{{1, 0, 10.0, 10.0}}};
  const auto solver = make_reference_solver(problem, {});
  std::vector<double> qpos = robot->zero_configuration();
  std::vector<Pose> bodies(robot->bodies().size());
  forward_kinematics(*robot, qpos, bodies);
  // Already at the target: one step without change.
  const PassResult there = solver->solve_pass(0, {{bodies[1]}}, qpos);
  EXPECT_EQ(there.steps, 1);
  EXPECT_LT(there.errors[1], 1e-12);
  EXPECT_EQ(qpos, robot->zero_configuration());
  // Far away: at most the first step and ten more.
  const PassResult far = solver->solve_pass(0, {{Pose{{1, 0, 0, 0}, {1e4, 0, 0}}}}, qpos);
  EXPECT_LE(far.steps, 11);
  for (int k = 1; k < far.steps; ++k) EXPECT_GT(far.errors[k - 1] - far.errors[k], 1e-3);
}

TEST(ReferenceSolver, ReportsNonFiniteTargets) {
  const auto robot = robot_from_text(kTwoArms);
  auto problem = make_problem(robot);
  problem->passes = {{{1, 0, 10.0, 10.0}}};
  const auto solver = make_reference_solver(problem, {});
  std::vector<double> qpos = robot->zero_configuration();
  const double nan = std::nan("");
  EXPECT_FALSE(solver->solve_pass(0, {{Pose{{1, 0, 0, 0}, {nan, 0, 0}}}}, qpos).converged);
}

}  // namespace
}  // namespace retarget
