// Joints held by a variant stay exactly at their held position for any target.

#include <gtest/gtest.h>

#include "ik/ik_cases.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// The two-armed robot with a joint held away from its qpos0, and a motion with a slide joint.
std::shared_ptr<const Robot> held_arms() {
  const TemporaryFolder folder;
  const auto robot = value_of(load_robot_files(folder.write("robot.xml", kTwoArms)));
  auto held = std::const_pointer_cast<Robot>(robot);
  held->set_variant(
      {"held", "", {{"right_shoulder", -0.3}, {"right_slide", 0.05}, {"left_twist", 7.0}}});
  return held;
}

TEST(HeldJoints, StayExactlyThereWithBothEngines) {
  const auto robot = held_arms();
  int moved = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const IkCase ik_case = random_case(robot, 4, seed);
    for (const bool is_fast : {false, true}) {
      const auto solver =
          is_fast ? make_fast_solver(ik_case.problem) : make_reference_solver(ik_case.problem);
      std::vector<double> qpos = robot->zero_configuration();
      ASSERT_EQ(qpos[11], -0.3);
      for (const int pass : {0, 1, 0, 1}) {
        EXPECT_TRUE(solver->solve_pass(pass, ik_case.targets, qpos).converged);
      }
      EXPECT_EQ(qpos[11], -0.3);
      EXPECT_EQ(qpos[10], 0.05);
      EXPECT_EQ(qpos[9], 7.0);
      moved += qpos[8] != 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(moved, 40);  // the elbow, where it is not pulled against its limit
}

}  // namespace
}  // namespace retarget
