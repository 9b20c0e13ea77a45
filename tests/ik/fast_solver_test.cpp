// The fast engine against the reference engine.

#include <gtest/gtest.h>

#include <cmath>

#include "base/math/se3.h"
#include "ik/ik_cases.h"
#include "solve/ik/published_jacobian.h"
#include "support/exp_se3.h"

namespace retarget {
namespace {

// Largest difference of two configurations; quaternions are compared up to sign.
double difference(std::span<const double> a, std::span<const double> b) {
  double dot = 0.0;
  for (int i = 3; i < 7; ++i) dot += a[i] * b[i];
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool flip = i >= 3 && i < 7 && dot < 0.0;
    largest = std::max(largest, std::abs(a[i] - (flip ? -b[i] : b[i])));
  }
  return largest;
}

// Runs a pass of each engine from the same start; returns their largest difference.
double engines_differ(const IkCase& ik_case, const IkOptions& options, int pass) {
  const auto reference = make_reference_solver(ik_case.problem, options);
  const auto fast = make_fast_solver(ik_case.problem, options);
  std::vector<double> expected = ik_case.start, found = ik_case.start;
  const PassResult a = reference->solve_pass(pass, ik_case.targets, expected);
  const PassResult b = fast->solve_pass(pass, ik_case.targets, found);
  EXPECT_TRUE(a.converged && b.converged);
  EXPECT_EQ(a.steps, b.steps);
  for (int k = 0; k <= std::min(a.steps, b.steps); ++k) EXPECT_NEAR(a.errors[k], b.errors[k], 1e-9);
  return difference(expected, found);
}

TEST(FastSolver, MatchesReferenceStepsOnRandomProblems) {
  for (const auto& robot : {load_g1(), robot_from_text(kTwoArms)}) {
    for (unsigned seed = 0; seed < 60; ++seed) {
      const IkCase ik_case = random_case(robot, 1 + static_cast<int>(seed) % 20, seed);
      IkOptions options;
      options.max_extra_steps = static_cast<int>(seed) % 11;
      EXPECT_LT(engines_differ(ik_case, options, static_cast<int>(seed) % 2), 1e-9)
          << robot->name() << ", seed " << seed;
    }
  }
}

TEST(FastSolver, ReturnsJointsThatStartOutsideTheirLimits) {
  const auto robot = robot_from_text(kTwoArms);
  IkCase ik_case = random_case(robot, 1, 4);
  // One task on the base: no joint is pulled, all start outside their limits.
  ik_case.problem->passes[0] = {{1, 0, 10.0, 10.0}};
  for (const RobotJoint& joint : robot->joints()) ik_case.start[joint.qpos_address] = 4.0;
  EXPECT_LT(engines_differ(ik_case, {}, 0), 1e-12);
}

TEST(FastSolver, TasksOnFixedBodiesOnlyAddToTheError) {
  const auto robot = robot_from_text(R"(
<mujoco><worldbody>
  <body name="post" pos="1 0 0"><geom size="0.1"/></body>
  <body name="base"><freejoint/><geom size="0.1"/>
    <body name="tip" pos="0 0 1"><joint name="j" axis="0 -1 0" limited="false"/><geom size="0.1"/></body>
  </body>
</worldbody></mujoco>)");
  IkCase ik_case = random_case(robot, 3, 8);
  EXPECT_LT(engines_differ(ik_case, {}, 0), 1e-9);
}

// Squares of such distances overflow.
TEST(IkEngines, ReportErrorsThatAreNotFinite) {
  IkCase ik_case = random_case(load_g1(), 10, 3);
  for (const double bad : {1e160, 1e200, std::nan("")}) {
    ik_case.targets[2].translation.x() = bad;
    const auto reference = make_reference_solver(ik_case.problem);
    const auto fast = make_fast_solver(ik_case.problem);
    for (IkSolver* const solver : {reference.get(), fast.get()}) {
      std::vector<double> qpos = ik_case.start;
      EXPECT_FALSE(solver->solve_pass(1, ik_case.targets, qpos).converged) << bad;
    }
  }
}

}  // namespace
}  // namespace retarget
