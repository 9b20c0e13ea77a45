#include "solve/dynamics/ankle_reach.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// A shank with a knee, then pitch and roll of an ankle 2 cm apart.
constexpr const char* kAnkle = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 1">
      <freejoint/>
      <geom size="0.1" mass="1"/>
      <body name="shank" pos="0 0 -0.2">
        <joint name="knee" axis="0 1 0"/>
        <geom size="0.05" mass="1"/>
        <body name="ankle" pos="0 0 -0.4">
          <joint name="pitch" axis="0 1 0"/>
          <geom size="0.02" mass="0.1"/>
          <body name="foot" pos="0 0 -0.02">
            <joint name="roll" axis="1 0 0"/>
            <geom size="0.02" mass="0.1"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

class AnkleReach : public testing::Test {
 protected:
  // Returns the moved point in world axes, relative to the foot's origin.
  Vector3d moved(double pitch_limit, double roll_limit, const Vector3d& point,
                 const Vector3d& force = {0.0, 0.0, 400.0}) const {
    const KinematicTree& tree = robot_->tree();
    const TreeState state(tree, robot_->zero_configuration());
    std::vector<double> limits(tree.links().size(), std::numeric_limits<double>::infinity());
    limits[2] = pitch_limit;
    limits[3] = roll_limit;
    const Eigen::Quaterniond world_from_link = state.world_from_link[3].rotation;
    return world_from_link * within_ankle_reach(tree, limits, 3,
                                                world_from_link.conjugate() * Vector3d::UnitZ(),
                                                world_from_link.conjugate() * force,
                                                world_from_link.conjugate() * point);
  }

  std::shared_ptr<const Robot> robot_ = robot_from_text(kAnkle);
};

TEST_F(AnkleReach, APointMovesToTheDistanceThatTheTorqueAllows) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  // 400 N at 0.15 m before the axis would need 60 N m.
  const Vector3d toe(0.15, 0.03, -0.05);
  EXPECT_LT((moved(kNone, kNone, toe) - toe).norm(), 1e-12);
  EXPECT_LT((moved(61.0, 13.0, toe) - toe).norm(), 1e-12);
  EXPECT_LT((moved(40.0, 13.0, toe) - Vector3d(0.1, 0.03, -0.05)).norm(), 1e-12);
  EXPECT_LT((moved(40.0, 8.0, toe) - Vector3d(0.1, 0.02, -0.05)).norm(), 1e-12);
  const Vector3d heel(-0.12, -0.04, -0.05);
  EXPECT_LT((moved(20.0, 4.0, heel) - Vector3d(-0.05, -0.01, -0.05)).norm(), 1e-12);
}

// The pitch axis is 0.07 m above the sole, so friction has a torque of its own.
TEST_F(AnkleReach, FrictionMovesThePointAlongTheSole) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Vector3d toe(0.15, 0.03, -0.05);
  for (const double push : {-100.0, 100.0}) {
    const Vector3d force(push, 0.0, 400.0);
    const Vector3d at = moved(40.0, kNone, toe, force);
    EXPECT_NEAR(at.y(), toe.y(), 1e-12);
    EXPECT_NEAR(at.z(), toe.z(), 1e-12);
    const Vector3d lever = at - Vector3d(0.0, 0.0, 0.02);
    EXPECT_NEAR(lever.z() * force.x() - lever.x() * force.z(), -40.0, 1e-9);
  }
}

}  // namespace
}  // namespace retarget
