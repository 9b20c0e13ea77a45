// Limbs whose elbow or knee is a hinge.

#include "solve/targets/targets.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// An arm of bones along X, bent about -Z of the upper one, with its forearm rotated about its own
// axis.
struct Arm {
  Pose upper, lower, end;
};
Arm arm_with(const Quaterniond& upper, double bend, double twist) {
  Arm arm;
  arm.upper = {upper, {0.3, -0.2, 1.4}};
  arm.lower.rotation = upper * exp_so3(Vector3d(0, 0, -bend)) * exp_so3(Vector3d(twist, 0, 0));
  arm.lower.translation = arm.upper.translation + upper * Vector3d(0.3, 0, 0);
  arm.end = {arm.lower.rotation, arm.lower.translation + arm.lower.rotation * Vector3d(0.25, 0, 0)};
  return arm;
}

double between(const Quaterniond& a, const Quaterniond& b) {
  return log_so3(a.conjugate() * b).norm();
}

const Quaterniond kUpper = exp_so3(Vector3d(0.4, -1.1, 0.7));

TEST(LimbAim, PureHingeKeepsBoneRotations) {
  for (const double bend : {0.0, 0.1, 0.8, 2.0}) {
    const Arm arm = arm_with(kUpper, bend, 0.0);
    const auto aimed = aim_limb(arm.upper, arm.lower, arm.end).value();
    EXPECT_LT(between(aimed.upper, arm.upper.rotation), 1e-9) << bend;
    EXPECT_LT(between(aimed.lower, arm.lower.rotation), 1e-9) << bend;
  }
}

TEST(LimbAim, DirectionIgnoresBoneTwist) {
  // The upper bone is rotated about its axis by 30 degrees, the forearm by 50, which no robot elbow
  // can do.
  const Arm plain = arm_with(kUpper, 1.2, 0.0);
  Arm arm = plain;
  arm.upper.rotation = arm.upper.rotation * exp_so3(Vector3d(30 * kDegree, 0, 0));
  arm.lower.rotation = arm.lower.rotation * exp_so3(Vector3d(50 * kDegree, 0, 0));
  const auto aimed = aim_limb(arm.upper, arm.lower, arm.end).value();
  const Vector3d first = (arm.lower.translation - arm.upper.translation).normalized();
  const Vector3d second = (arm.end.translation - arm.lower.translation).normalized();
  EXPECT_LT((aimed.upper * Vector3d::UnitX() - first).norm(), 1e-9);
  EXPECT_LT((aimed.lower * Vector3d::UnitX() - second).norm(), 1e-9);
  // The elbow of the upper bone then lets the forearm point there, up to the inclination of its own
  // axis: a rotation by atan(0.1 sin 30 / (sin(1.2 rad) + 0.1 cos 30)).
  EXPECT_LT(between(aimed.upper, plain.upper.rotation), 3.0 * kDegree);
  EXPECT_GT(between(arm.upper.rotation, plain.upper.rotation), 29.0 * kDegree);
}

TEST(LimbAim, StraightLimbUsesTheUpperBoneAxis) {
  Arm arm = arm_with(kUpper, 0.0, 0.9);
  const auto aimed = aim_limb(arm.upper, arm.lower, arm.end).value();
  EXPECT_LT(between(aimed.upper, kUpper), 1e-9);
  EXPECT_LT(between(aimed.lower, kUpper), 1e-9);
}

TEST(LimbAim, LimbBentTheWrongWayIsStraightened) {
  for (const double bend : {-0.05, -0.1, -0.15, -0.3}) {
    Arm arm = arm_with(kUpper, bend, 0.0);
    const auto aimed = aim_limb(arm.upper, arm.lower, arm.end).value();
    EXPECT_LT(between(aimed.upper, kUpper), 1e-9) << bend;
    // Also slightly sideways: the hinge rotates only by the weight of its own axis.
    arm.end.translation += kUpper * Vector3d(0.0, 0.0, 0.25 * std::sin(2.0 * kDegree));
    const auto aside = aim_limb(arm.upper, arm.lower, arm.end).value();
    EXPECT_LT(between(aside.upper, kUpper), 30.0 * kDegree) << bend;
  }
}

TEST(LimbAim, KneesBendAsElbowsDo) {
  // The shin bends back: about the left, which is -Z of a thigh.
  const Bone thigh = Bone::kLeftUpLeg, shin = Bone::kLeftLeg;
  const Quaterniond bent = exp_so3(Vector3d(0, 0.7, 0));
  const Pose upper{Quaterniond(canonical_t_pose(thigh)), {0, 0.1, 0.9}};
  const Pose lower{bent * Quaterniond(canonical_t_pose(shin)), {0, 0.1, 0.45}};
  const Pose end{lower.rotation, lower.translation + bent * Vector3d(0, 0, -0.42)};
  const auto aimed = aim_limb(upper, lower, end).value();
  EXPECT_LT(between(aimed.upper, upper.rotation), 1e-9);
  EXPECT_LT(between(aimed.lower, lower.rotation), 1e-9);
}

TEST(LimbAim, RejectsZeroLengthLimb) {
  EXPECT_FALSE(aim_limb({}, {}, {}));
}

}  // namespace
}  // namespace retarget
