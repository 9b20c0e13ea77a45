// The solvers make no allocations.

#include <gtest/gtest.h>

#include "ik/ik_cases.h"
#include "solve/ik/box_qp.h"
#include "support/counted_allocations.h"

namespace retarget {
namespace {

TEST(Solvers, AllocateNothingPerFrame) {
  const auto robot = load_g1();
  const IkCase ik_case = random_case(robot, 12, 3);
  for (const bool fast : {false, true}) {
    const auto solver =
        fast ? make_fast_solver(ik_case.problem) : make_reference_solver(ik_case.problem);
    std::vector<double> qpos = ik_case.start;
    const long before = allocations;
    for (int frame = 0; frame < 20; ++frame) {
      qpos = ik_case.start;
      solver->solve_pass(0, ik_case.targets, qpos);
      solver->solve_pass(1, ik_case.targets, qpos);
    }
    EXPECT_EQ(allocations, before) << (fast ? "fast" : "reference");
  }
}

TEST(Solvers, DenseLeastSquaresAllocatesNothingPerStep) {
  DenseLeastSquares system(6);
  system.hessian.setIdentity();
  system.gradient.setLinSpaced(-1.0, 1.0);
  system.lower.setConstant(-0.5);
  system.upper.setConstant(0.5);
  const long before = allocations;
  EXPECT_TRUE(system.solve(1e-3).has_value());
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace retarget
