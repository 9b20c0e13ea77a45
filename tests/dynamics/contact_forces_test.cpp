// Distribution of forces over contacts: closed forms for joints near their limits.

#include "solve/dynamics/contact_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/dynamics/inertias.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/support_points.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// A base whose centre of mass is 15 cm in front of two legs. The left leg has one hinge, the right
// leg three on the same axis; all links except the base have hardly any mass.
constexpr const char* kTwoLegs = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 0.1">
      <freejoint/>
      <inertial pos="0.15 0 0.3" mass="10" diaginertia="0.1 0.1 0.1"/>
      <body name="left" pos="0 0.1 0">
        <joint name="left" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="1e-4" diaginertia="1e-6 1e-6 1e-6"/>
      </body>
      <body name="right0" pos="0 -0.1 0">
        <joint name="right0" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="1e-4" diaginertia="1e-6 1e-6 1e-6"/>
        <body name="right1">
          <joint name="right1" axis="0 1 0"/>
          <inertial pos="0 0 0" mass="1e-4" diaginertia="1e-6 1e-6 1e-6"/>
          <body name="right2">
            <joint name="right2" axis="0 1 0"/>
            <inertial pos="0 0 0" mass="1e-4" diaginertia="1e-6 1e-6 1e-6"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

constexpr double kLean = 0.15 * 10.0 * kGravity;  // N m about the hinges.
constexpr double kNear = 0.02 * kLean;            // The weights are finite.

class TwoLegs : public testing::Test {
 protected:
  // The torques of the four joints when the robot stands still.
  // @param limits  N m, of these joints.
  std::vector<double> torques(const std::vector<double>& limits) {
    const KinematicTree& tree = robot_->tree();
    const Inertias inertias = make_inertias(*robot_);
    std::vector<double> by_link{std::numeric_limits<double>::infinity()};
    by_link.insert(by_link.end(), limits.begin(), limits.end());
    InverseDynamics inverse(tree, inertias);
    const TreeState state(tree, robot_->zero_configuration());
    const std::vector<double> none(static_cast<std::size_t>(tree.dof_count()), 0.0);
    inverse.compute(state, none, none);
    // Four corners of a foot below each leg.
    std::vector<SupportPoint> points;
    for (const int link : {1, 4}) {
      for (const double x : {-0.2, 0.2}) {
        for (const double y : {-0.05, 0.05}) {
          const Pose& world = state.world_from_link[static_cast<std::size_t>(link)];
          const Vector3d place(x, (link == 1 ? 0.1 : -0.1) + y, 0.0);
          points.push_back({link, world.inverse() * place, 0.0, true});
        }
      }
    }
    std::vector<const SupportPoint*> supports;
    std::vector<ContactPlace> places;
    for (const SupportPoint& point : points) {
      supports.push_back(&point);
      places.push_back({lowest_of(point, state)});
    }
    ContactForces contacts(tree, by_link, inertias.mass * kGravity);
    contacts.solve(inverse, state, supports, places);
    EXPECT_LT(contacts.unexplained().force.norm(), 0.01 * inertias.mass * kGravity);
    EXPECT_LT(contacts.unexplained().torque.norm(), kNear);
    const std::span<const double> found = contacts.joint_torques();
    return {found.begin() + 1, found.end()};
  }

  std::shared_ptr<const Robot> robot_ = robot_from_text(kTwoLegs);
};

// The least squares of the torque ratios, subject to left + right = lean: left / l^2 = 3 right /
// r^2.
TEST_F(TwoLegs, TorquesWithinLimitsAreTheLeastSquares) {
  const std::vector<double> found = torques({20.0, 30.0, 30.0, 30.0});
  ASSERT_EQ(found.size(), 4U);
  const double left = kLean * 3.0 * 400.0 / (3.0 * 400.0 + 900.0);
  EXPECT_NEAR(std::abs(found[0]), left, kNear);
  EXPECT_NEAR(std::abs(found[3]), kLean - left, kNear);
}

// The same shares would exceed the limit of the left joint, although the right leg has torque to
// spare.
TEST_F(TwoLegs, AJointIsRelievedIfOthersCanTakeItsTorque) {
  const std::vector<double> limits{7.5, 11.25, 11.25, 11.25};
  const double least_squares = kLean * 3.0 / (3.0 + 1.5 * 1.5);
  ASSERT_GT(least_squares, 1.1 * limits[0]);
  const std::vector<double> found = torques(limits);
  for (std::size_t i = 0; i < limits.size(); ++i) EXPECT_LT(std::abs(found[i]), limits[i]) << i;
  EXPECT_NEAR(std::abs(found[0]) + std::abs(found[3]), kLean, kNear);
}

// If the lean needs more than the limits of all joints, the sum of squared excesses is minimal: e /
// l = 3 f / r with e = left - 0.98 l and f = right - 0.98 r, both in units of their limits.
TEST_F(TwoLegs, RemainingExcessIsMinimal) {
  const double l = 4.5, r = 6.75;
  const std::vector<double> found = torques({l, r, r, r});
  // left / l - 0.98 = l k, right / r - 0.98 = r k / 3
  const double k = (kLean - 0.98 * (l + r)) / (l * l + r * r / 3.0);
  EXPECT_NEAR(std::abs(found[0]), l * (0.98 + l * k), kNear);
  EXPECT_NEAR(std::abs(found[3]), r * (0.98 + r * k / 3.0), kNear);
}

}  // namespace
}  // namespace retarget
