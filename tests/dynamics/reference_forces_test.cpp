// Forces and torques of references: those of MuJoCo's inverse dynamics, and closed forms.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/math/gravity.h"
#include "dynamics/inverse_model.h"
#include "dynamics/references.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The centre of mass moves according to its velocity and acceleration, and the forces accelerate
// it.
TEST(ReferenceForces, TheCentreOfMassFollowsItsForces) {
  const MotionReference reference =
      reference_of(reference_sway(load_shipped("unitree_g1"), 40), 990.0);
  const std::size_t rows = reference.samples;
  const double h = 1.0 / 990.0;
  for (std::size_t i = 2; i + 2 < rows; ++i) {
    if (i % 33 < 2 || i % 33 > 31) continue;
    const auto at = [&](const std::vector<double>& of, std::size_t row) {
      return three_of(row_of(of, rows, row));
    };
    const auto slope = [&](const std::vector<double>& of) {
      return Vector3d((8.0 * (at(of, i + 1) - at(of, i - 1)) - at(of, i + 2) + at(of, i - 2)) /
                      (12.0 * h));
    };
    EXPECT_LT((slope(reference.com) - at(reference.com_velocity, i)).norm(), 1e-9);
    EXPECT_LT((slope(reference.com_velocity) - at(reference.com_acceleration, i)).norm(), 1e-6);
    // Newton and Euler: forces of contacts and the residual.
    Vector3d force = at(reference.residual, i);
    const Quaterniond root = rotation_of(row_of(reference.qpos, rows, i));
    const Vector3d origin = three_of(row_of(reference.qpos, rows, i));
    Vector3d torque = root * three_of(row_of(reference.residual, rows, i), 3) +
                      (origin - at(reference.com, i)).cross(force);
    const auto places = row_of(reference.contact_position, rows, i);
    const auto forces = row_of(reference.contact_force, rows, i);
    for (std::size_t p = 0; p < reference.contact_names.size(); ++p) {
      force += three_of(forces, 3 * p);
      torque += (three_of(places, 3 * p) - at(reference.com, i)).cross(three_of(forces, 3 * p));
    }
    const Vector3d needed =
        reference.mass * (at(reference.com_acceleration, i) + kGravity * Vector3d::UnitZ());
    EXPECT_LT((force - needed).norm(), 1e-9 * needed.norm());
    EXPECT_LT((slope(reference.angular_momentum) - torque).norm(), 1e-5);
  }
}

// MuJoCo's inverse dynamics of a reference with its contact forces applied.
class MujocoInverse {
 public:
  explicit MujocoInverse(const Robot& robot)
      : robot_(robot),
        model_(inverse_model(robot)),
        data_(mj_makeData(model_.get()), mj_deleteData) {}

  // Generalised forces by degree of freedom in the reference's order.
  std::vector<double> forces(const MotionReference& reference, std::size_t row) {
    const std::size_t rows = reference.samples;
    const auto q = row_of(reference.qpos, rows, row), v = row_of(reference.qvel, rows, row),
               a = row_of(reference.qacc, rows, row);
    std::copy_n(q.begin(), 7, data_->qpos);
    std::copy_n(v.begin(), 6, data_->qvel);
    std::copy_n(a.begin(), 6, data_->qacc);
    for (std::size_t i = 0; i < reference.joint_names.size(); ++i) {
      const RobotJoint& joint = joint_of(reference.joint_names[i]);
      data_->qpos[joint.qpos_address] = q[7 + i];
      data_->qvel[joint.dof_address] = v[6 + i];
      data_->qacc[joint.dof_address] = a[6 + i];
    }
    mj_inverse(model_.get(), data_.get());
    std::vector<double> found(data_->qfrc_inverse, data_->qfrc_inverse + model_->nv);
    const auto places = row_of(reference.contact_position, rows, row);
    const auto pushes = row_of(reference.contact_force, rows, row);
    for (std::size_t p = 0; p < reference.contact_names.size(); ++p) {
      std::vector<double> of_contact(found.size(), 0.0);
      const Vector3d force = three_of(pushes, 3 * p), place = three_of(places, 3 * p);
      const Vector3d torque = Vector3d::Zero();
      const int body = *robot_.find_body(reference.contact_links[p]);
      mj_applyFT(model_.get(), data_.get(), force.data(), torque.data(), place.data(), body,
                 of_contact.data());
      for (std::size_t k = 0; k < found.size(); ++k) found[k] -= of_contact[k];
    }
    std::vector<double> ordered(found.begin(), found.begin() + 6);
    for (const std::string& name : reference.joint_names) {
      ordered.push_back(found[static_cast<std::size_t>(joint_of(name).dof_address)]);
    }
    return ordered;
  }

 private:
  [[nodiscard]] const RobotJoint& joint_of(const std::string& name) const {
    return robot_.joints()[static_cast<std::size_t>(*robot_.find_joint(name))];
  }

  const Robot& robot_;
  ModelPointer model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
};

TEST(ReferenceForces, TorquesMatchMujoco) {
  for (const char* name :
       {"unitree_g1", "unitree_h1", "booster_t1", "pal_talos", "stanford_toddy"}) {
    const auto robot = load_shipped(name);
    const MotionReference reference = reference_of(reference_sway(robot, 40), 50.0);
    ASSERT_TRUE(reference.has_dynamics);
    EXPECT_FALSE(reference.contact_names.empty()) << name;
    MujocoInverse mujoco(*robot);
    const std::size_t rows = reference.samples, joints = reference.joint_names.size();
    double pushed = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
      const std::vector<double> expected = mujoco.forces(reference, i);
      double scale = reference.mass * kGravity;
      for (const double each : expected) scale = std::max(scale, std::abs(each));
      for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(reference.residual[6 * i + k], expected[k], 1e-9 * scale) << name;
      }
      for (std::size_t k = 0; k < joints; ++k) {
        EXPECT_NEAR(reference.torque[joints * i + k], expected[6 + k], 1e-9 * scale) << name;
      }
      for (const double each : row_of(reference.contact_force, rows, i)) {
        pushed = std::max(pushed, each);
      }
    }
    EXPECT_GT(pushed, 0.05 * reference.mass * kGravity) << name;
  }
}

TEST(ReferenceForces, AFallingBodyNeedsNoForces) {
  RobotClip clip = reference_stand(load_shipped("unitree_g1"), 20);
  for (int t = 0; t < 20; ++t) {
    const double time = t / 30.0;
    clip.qpos(t)[0] += 0.7 * time;
    clip.qpos(t)[2] += 0.5 + 3.0 * time - 0.5 * kGravity * time * time;
  }
  const MotionReference reference = reference_of(clip, 200.0);
  EXPECT_TRUE(reference.contact_names.empty());
  EXPECT_TRUE(reference.beyond.empty());
  for (const double torque : reference.torque) EXPECT_NEAR(torque, 0.0, 1e-8);
  for (const double each : reference.residual) EXPECT_NEAR(each, 0.0, 1e-6);
  for (const double each : reference.angular_momentum) EXPECT_NEAR(each, 0.0, 1e-9);
  for (std::size_t i = 0; i < reference.samples; ++i) {
    EXPECT_NEAR(reference.com_acceleration[3 * i + 2], -kGravity, 1e-8);
    EXPECT_NEAR(reference.com_velocity[3 * i], 0.7, 1e-9);
  }
}

TEST(ReferenceForces, AStandingBodysForcesSumToItsWeight) {
  for (const char* name : {"unitree_g1", "booster_t1", "pal_talos"}) {
    const MotionReference reference = reference_of(reference_stand(load_shipped(name), 20), 100.0);
    const std::size_t points = reference.contact_names.size();
    EXPECT_GE(points, 4U);
    const double weight = reference.mass * kGravity;
    for (std::size_t i = 0; i < reference.samples; ++i) {
      Vector3d sum = Vector3d::Zero(), moment = sum;
      for (std::size_t p = 0; p < points; ++p) {
        const Vector3d force = three_of(reference.contact_force, 3 * (points * i + p));
        const Vector3d place = three_of(reference.contact_position, 3 * (points * i + p));
        EXPECT_GE(force.z(), -1e-12);
        EXPECT_LE(force.head<2>().norm(), 0.8 * force.z() + 1e-9);
        EXPECT_TRUE(reference.contacts[points * i + p] != 0 || force.norm() == 0.0);
        sum += force;
        moment += (place - three_of(reference.com, 3 * i)).cross(force);
      }
      EXPECT_NEAR(sum.z(), weight, 2e-3 * weight) << name;
      EXPECT_LT(sum.head<2>().norm(), 2e-3 * weight) << name;
      EXPECT_LT(moment.norm(), 2e-3 * weight) << name;
      EXPECT_NEAR(sum.z() + reference.residual[6 * i + 2], weight, 1e-9 * weight) << name;
    }
  }
}

// A point mass on a rod, hinged to a stand.
constexpr const char* kPendulum = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="stand" pos="0 0 2">
      <freejoint/>
      <geom size="0.05" mass="1" contype="0" conaffinity="0"/>
      <body name="rod">
        <joint name="hinge" axis="0 1 0"/>
        <inertial pos="0 0 -0.8" mass="2.5" diaginertia="1e-9 1e-9 1e-9"/>
      </body>
    </body>
  </worldbody>
</mujoco>)";

TEST(ReferenceForces, PendulumTorqueMatchesItsClosedForm) {
  const auto loaded = robot_from_text(kPendulum);
  auto fixed =
      std::make_shared<Robot>(ModelPtr(mj_copyModel(nullptr, loaded->model())), loaded->profile());
  RobotProfile profile = loaded->profile();
  profile.fixed_base = true;
  fixed->set_profile(profile);
  RobotClip clip(fixed, {30, 1}, 60);
  for (int t = 0; t < 60; ++t) clip.qpos(t)[7] = 0.9 * std::sin(5.0 * t / 30.0);
  const MotionReference reference = reference_of(clip, 200.0);
  EXPECT_TRUE(reference.contact_names.empty());
  constexpr double kMass = 2.5, kLength = 0.8;
  for (std::size_t i = 0; i < reference.samples; ++i) {
    const double q = reference.qpos[8 * i + 7], a = reference.qacc[7 * i + 6];
    EXPECT_NEAR(reference.torque[i],
                kMass * kLength * kLength * a + kMass * kLength * kGravity * std::sin(q), 1e-6);
    // The stand carries the weight of both parts and the force of the swing.
    const double v = reference.qvel[7 * i + 6];
    const double lift = kMass * kLength * (a * std::sin(q) + v * v * std::cos(q));
    EXPECT_NEAR(reference.residual[6 * i + 2], (1.0 + kMass) * kGravity + lift, 1e-6);
  }
}

}  // namespace
}  // namespace retarget
