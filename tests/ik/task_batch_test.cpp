#include "solve/ik/task_batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "base/math/se3.h"
#include "solve/ik/published_jacobian.h"

namespace retarget {
namespace {

// Bodies whose targets are rotated by angles around all thresholds of the formulas, and a number of
// tasks that does not fill the last vector.
class TaskBatchTest : public testing::Test {
 protected:
  TaskBatchTest() {
    for (const double angle :
         {0.0, 1e-12, 1e-7, 0.9e-5, 1.1e-5, 1e-3, 0.0199, 0.0201, 0.3, 0.9, 1.2, 2.0, 3.0, 3.14}) {
      link_from_body_.push_back(random_pose());
      world_from_link_.push_back(random_pose());
      const Eigen::Vector3d axis = random_vector().normalized();
      const Pose body_from_target{exp_so3(angle * axis), 0.2 * random_vector()};
      world_from_target_.push_back(world_from_body(size() - 1) * body_from_target);
    }
    batch_ = TaskBatch(link_from_body_);
    weights_ = batch_.zero_weights();
    for (int i = 0; i < size(); ++i) {
      batch_.set_link(i, world_from_link_[i]);
      // The same rotation with the other sign.
      Pose target = world_from_target_[i];
      if (i % 2 == 1) target.rotation.coeffs() *= -1.0;
      batch_.set_target(i, target);
      weights_.position[i] = 10.0 * (i % 3);
      weights_.rotation[i] = 5.0 + i;
    }
    batch_.measure(origin_);
  }

  [[nodiscard]] int size() const { return static_cast<int>(link_from_body_.size()); }
  [[nodiscard]] Pose world_from_body(int i) const {
    return world_from_link_[i] * link_from_body_[i];
  }
  // In the axes of the body.
  [[nodiscard]] Vector6d error(int i) const {
    return log_se3(world_from_body(i).inverse() * world_from_target_[i]);
  }

  // 1/2 |W (J V + e)|^2 without the constant, by the Jacobian of the reference engine. V is the
  // velocity of a point at the origin and the angular velocity, in world axes.
  [[nodiscard]] Composite expected_form(int i) const {
    const Vector6d error = this->error(i);
    const Eigen::Matrix3d R = world_from_body(i).rotation.conjugate().toRotationMatrix();
    Matrix6d body_from_origin;
    body_from_origin << R, -R * skew(world_from_body(i).translation - origin_),
        Eigen::Matrix3d::Zero(), R;
    const Matrix6d jacobian = -published_jacobian_inverse(error) * body_from_origin;
    Vector6d weights;
    weights << Eigen::Vector3d::Constant(weights_.position[i]),
        Eigen::Vector3d::Constant(weights_.rotation[i]);
    const Matrix6d hessian = jacobian.transpose() * weights.asDiagonal() * jacobian;
    const Vector6d gradient = jacobian.transpose() * weights.asDiagonal() * error;
    Composite form;
    form.linear = hessian.topLeftCorner<3, 3>();
    form.mixed = hessian.topRightCorner<3, 3>();
    form.angular = hessian.bottomRightCorner<3, 3>();
    form.force = gradient.head<3>();
    form.torque = gradient.tail<3>();
    return form;
  }

  TaskBatch batch_;
  TaskBatch::Weights weights_;
  const Eigen::Vector3d origin_{0.1, -0.2, 0.9};

 private:
  Eigen::Vector3d random_vector() { return {normal_(engine_), normal_(engine_), normal_(engine_)}; }
  Pose random_pose() {
    const Eigen::Vector3d turn = random_vector();
    return {exp_so3(turn), random_vector()};
  }

  std::mt19937 engine_{5};
  std::normal_distribution<double> normal_;
  std::vector<Pose> link_from_body_, world_from_link_, world_from_target_;
};

TEST_F(TaskBatchTest, ErrorsEqualTheLogarithm) {
  for (int i = 0; i < size(); ++i) {
    const Vector6d expected = error(i);
    EXPECT_NEAR(batch_.squared_error(i), expected.squaredNorm(), 1e-14) << i;
    const double weighted = weights_.position[i] * expected.head<3>().squaredNorm() +
                            weights_.rotation[i] * expected.tail<3>().squaredNorm();
    EXPECT_NEAR(batch_.weighted_error(i, weights_), weighted, 1e-12) << i;
  }
}

TEST_F(TaskBatchTest, FormsEqualThoseOfTheReferenceJacobian) {
  batch_.build_forms(weights_);
  for (int i = 0; i < size(); ++i) {
    Composite found;
    batch_.add_form(i, found);
    batch_.add_form(i, found);
    const Composite expected = expected_form(i);
    // The closed forms lose digits at small angles.
    const double angle = error(i).tail<3>().norm();
    const double tolerance = angle < 0.01 && angle > 1e-5 ? 1e-7 : 1e-10;
    EXPECT_LT((found.linear - 2.0 * expected.linear).norm(), tolerance) << i;
    EXPECT_LT((found.mixed - 2.0 * expected.mixed).norm(), tolerance) << i;
    EXPECT_LT((found.angular - 2.0 * expected.angular).norm(), tolerance) << i;
    EXPECT_LT((found.force - 2.0 * expected.force).norm(), tolerance) << i;
    EXPECT_LT((found.torque - 2.0 * expected.torque).norm(), tolerance) << i;
  }
}

TEST_F(TaskBatchTest, ErrorsThatAreNotFiniteStayInTheirTask) {
  const double before = batch_.squared_error(1);
  batch_.set_target(2, {Eigen::Quaterniond::Identity(), {std::nan(""), 0.0, 0.0}});
  batch_.measure(origin_);
  EXPECT_FALSE(std::isfinite(batch_.squared_error(2)));
  EXPECT_EQ(batch_.squared_error(1), before);
}

}  // namespace
}  // namespace retarget
