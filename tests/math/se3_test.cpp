#include "base/math/se3.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

#include "retarget/so3.h"
#include "support/exp_se3.h"

namespace retarget {
namespace {

Eigen::Matrix4d hat(const Vector6d& twist) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  matrix.topLeftCorner<3, 3>() = skew(twist.tail<3>());
  matrix.topRightCorner<3, 1>() = twist.head<3>();
  return matrix;
}

TEST(ExpSe3, MatchesTheMatrixExponential) {
  RandomTwists twists;
  for (const double angle : {1e-9, 1e-6, 1e-3, 0.3, 1.5, 3.0}) {
    const Vector6d twist = twists.next(angle);
    const Pose pose = exp_se3(twist);
    const Eigen::Matrix4d expected = hat(twist).exp();
    EXPECT_LT((pose.rotation.toRotationMatrix() - expected.topLeftCorner<3, 3>()).norm(), 1e-13);
    EXPECT_LT((pose.translation - expected.topRightCorner<3, 1>()).norm(), 1e-10) << angle;
  }
}

TEST(LogSe3, InvertsExp) {
  RandomTwists twists;
  for (const double angle : {1e-9, 1e-6, 1e-4, 1e-2, 0.3, 1.5, 3.0, 3.14}) {
    for (int repeat = 0; repeat < 20; ++repeat) {
      const Vector6d twist = twists.next(angle);
      EXPECT_LT((log_se3(exp_se3(twist)) - twist).norm(), 1e-9) << angle;
    }
  }
}

TEST(LogSe3, DoesNotDependOnTheSignOfTheQuaternion) {
  RandomTwists twists;
  const Vector6d twist = twists.next(1.2);
  Pose pose = exp_se3(twist);
  pose.rotation.coeffs() = -pose.rotation.coeffs();
  EXPECT_LT((log_se3(pose) - twist).norm(), 1e-12);
}

}  // namespace
}  // namespace retarget
