// References for controllers: derivatives, MuJoCo's inverse dynamics, closed forms, limits.

#include "retarget/reference.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/math/gravity.h"
#include "dynamics/inverse_model.h"
#include "retarget/so3.h"
#include "robot/shipped_robots.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The robot in its zero configuration with its soles on the floor.
RobotClip reference_stand(const std::shared_ptr<const Robot>& robot, int frames) {
  RobotClip clip(robot, {30, 1}, frames);
  std::vector<Pose> bodies(robot->bodies().size());
  forward_kinematics(*robot, clip.qpos(0), bodies);
  double lowest = 1e9;
  for (const Sole& sole : robot->profile().soles) {
    for (const Vector3d& point : sole.points) {
      lowest = std::min(lowest, (bodies[static_cast<std::size_t>(sole.body)] * point).z());
    }
  }
  if (robot->profile().soles.empty()) lowest = 0.0;
  for (int t = 0; t < frames; ++t) clip.qpos(t)[2] -= lowest;
  return clip;
}

// The same with every joint, the root and its rotation in motion.
RobotClip reference_sway(const std::shared_ptr<const Robot>& robot, int frames) {
  RobotClip clip = reference_stand(robot, frames);
  for (int t = 0; t < frames; ++t) {
    const double time = t / 30.0;
    const auto q = clip.qpos(t);
    q[0] += 0.05 * std::sin(4.0 * time);
    q[1] += 0.03 * std::cos(5.0 * time);
    const Quaterniond turn = exp_so3(
        Vector3d(0.2 * std::sin(3.0 * time), 0.1 * time * time, 0.3 * std::sin(2.0 * time + 1.0)));
    q[3] = turn.w();
    for (int k = 0; k < 3; ++k) q[static_cast<std::size_t>(4 + k)] = turn.vec()[k];
    for (std::size_t j = 7; j < q.size(); ++j) {
      q[j] += 0.05 * std::sin(3.0 * time + static_cast<double>(j));
    }
  }
  return clip;
}

MotionReference reference_of(const RobotClip& clip, double rate) {
  ReferenceOptions options;
  options.rate = frame_rate_from_fps(rate);
  return value_of(make_reference(clip, options));
}

std::span<const double> row_of(const std::vector<double>& values, std::size_t rows,
                               std::size_t row) {
  const std::size_t width = values.size() / rows;
  return std::span(values).subspan(row * width, width);
}

Vector3d three_of(std::span<const double> values, std::size_t first = 0) {
  return {values[first], values[first + 1], values[first + 2]};
}

Quaterniond rotation_of(std::span<const double> qpos) {
  return {qpos[3], qpos[4], qpos[5], qpos[6]};
}

TEST(Reference, SamplesAreAtTheRequestedTimes) {
  const RobotClip clip = reference_sway(load_shipped("unitree_g1"), 31);
  for (const auto& [rate, count] : std::vector<std::pair<double, std::size_t>>{
           {50.0, 51}, {200.0, 201}, {500.0, 501}, {10.0, 11}, {1000.0, 1001}, {33.3, 34}}) {
    const MotionReference reference = reference_of(clip, rate);
    ASSERT_EQ(reference.samples, count) << rate;
    EXPECT_NEAR(reference.time.back(), static_cast<double>(count - 1) / rate, 1e-9);
    EXPECT_EQ(reference.qpos.size(), count * 36);
    EXPECT_EQ(reference.qvel.size(), count * 35);
    EXPECT_EQ(reference.torque.size(), count * 29);
  }
  // Samples at frame times equal the frames.
  const MotionReference at_frames = reference_of(clip, 30.0);
  ASSERT_EQ(at_frames.samples, 31U);
  for (int t = 0; t < 31; ++t) {
    const auto row = row_of(at_frames.qpos, 31, static_cast<std::size_t>(t));
    for (std::size_t k = 0; k < row.size(); ++k) EXPECT_NEAR(row[k], clip.qpos(t)[k], 1e-12);
  }
}

// 990 samples per second have 33 samples between two frames, so a fourth-order difference can stay
// within one piece of the spline: there it has no error for cubics and hardly any for the rotation.
TEST(Reference, VelocitiesAndAccelerationsAreDerivatives) {
  const MotionReference reference =
      reference_of(reference_sway(load_shipped("unitree_g1"), 40), 990.0);
  const std::size_t rows = reference.samples;
  const double h = 1.0 / 990.0;
  const auto difference = [&](const std::vector<double>& of, std::size_t i, std::size_t k) {
    const auto at = [&](std::size_t row) { return row_of(of, rows, row)[k]; };
    return (8.0 * (at(i + 1) - at(i - 1)) - at(i + 2) + at(i - 2)) / (12.0 * h);
  };
  const auto turn = [&](std::size_t from, std::size_t to) {
    return log_so3(rotation_of(row_of(reference.qpos, rows, from)).conjugate() *
                   rotation_of(row_of(reference.qpos, rows, to)));
  };
  double scale = 0.0;
  for (const double each : reference.qacc) scale = std::max(scale, std::abs(each));
  EXPECT_GT(scale, 0.5);
  int compared = 0;
  for (std::size_t i = 2; i + 2 < rows; ++i) {
    if (i % 33 < 2 || i % 33 > 31) continue;
    ++compared;
    const auto v = row_of(reference.qvel, rows, i), a = row_of(reference.qacc, rows, i);
    for (std::size_t k = 0; k < v.size(); ++k) {
      EXPECT_NEAR(difference(reference.qvel, i, k), a[k], 1e-8 * scale);
      if (k >= 3 && k < 6) continue;
      EXPECT_NEAR(difference(reference.qpos, i, k < 3 ? k : k + 1), v[k], 1e-9);
    }
    // In the axes of the body: log(R(-h)^-1 R(h)) / 2h, extrapolated from two steps.
    const Vector3d near = (turn(i, i + 1) - turn(i, i - 1)) / (2.0 * h);
    const Vector3d far = (turn(i, i + 2) - turn(i, i - 2)) / (4.0 * h);
    EXPECT_LT(((4.0 * near - far) / 3.0 - three_of(v, 3)).norm(), 1e-9);
  }
  EXPECT_GT(compared, 1000);
}

// The centre of mass moves according to its velocity and acceleration, and the forces accelerate
// it.
TEST(Reference, TheCentreOfMassFollowsItsForces) {
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

TEST(Reference, TorquesMatchMujoco) {
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

TEST(Reference, AFallingBodyNeedsNoForces) {
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

TEST(Reference, AStandingBodysForcesSumToItsWeight) {
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

TEST(Reference, PendulumTorqueMatchesItsClosedForm) {
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

TEST(Reference, LimitsHoldBetweenFrames) {
  const auto robot = load_shipped("unitree_g1");
  const auto limits = value_of(load_limits(*robot, robot->limits_for({})));
  const int knee = *robot->find_joint("left_knee_joint");
  const int shoulder = *robot->find_joint("left_shoulder_pitch_joint");
  const auto address = [&](int joint) {
    return static_cast<std::size_t>(robot->joints()[static_cast<std::size_t>(joint)].qpos_address);
  };
  const double top = limits.upper[static_cast<std::size_t>(knee)];
  const double step = robot->speed_limit(shoulder) / 30.0;
  RobotClip clip = reference_stand(robot, 60);
  for (int t = 0; t < 60; ++t) {
    clip.qpos(t)[2] += 1.0;
    // The knee reaches its limit at once and stays there.
    clip.qpos(t)[address(knee)] = t < 20 ? top - 0.3 : top;
    // The shoulder swings at its speed limit.
    const int phase = t % 4 < 2 ? t % 4 : 4 - t % 4;
    clip.qpos(t)[address(shoulder)] = step * 0.999 * (phase - 1);
  }
  for (const double rate : {50.0, 1000.0}) {
    const MotionReference reference = reference_of(clip, rate);
    const auto column = [&](const char* name) {
      return static_cast<std::size_t>(std::ranges::find(reference.joint_names, name) -
                                      reference.joint_names.begin());
    };
    const std::size_t k = column("left_knee_joint"), e = column("left_shoulder_pitch_joint");
    double highest = -10.0, fastest = 0.0;
    for (std::size_t i = 0; i < reference.samples; ++i) {
      highest = std::max(highest, reference.qpos[36 * i + 7 + k]);
      fastest = std::max(fastest, std::abs(reference.qvel[35 * i + 6 + e]));
    }
    EXPECT_LE(highest, top);
    EXPECT_GT(highest, top - 0.01);
    EXPECT_LE(fastest, robot->speed_limit(shoulder));
    ASSERT_EQ(reference.corrections.size(), 2U);
    for (const ReferenceLimit& beyond : reference.beyond) {
      EXPECT_EQ(beyond.kind, ReferenceLimit::Kind::kTorque) << beyond.joint;
    }
  }
  // A frame beyond a limit is reported.
  clip.qpos(40)[address(knee)] = top + 0.05;
  const MotionReference reported = reference_of(clip, 200.0);
  const auto found = std::ranges::find_if(reported.beyond, [](const ReferenceLimit& beyond) {
    return beyond.kind == ReferenceLimit::Kind::kPosition;
  });
  ASSERT_NE(found, reported.beyond.end());
  EXPECT_EQ(found->joint, "left_knee_joint");
  EXPECT_NEAR(found->time, 40.0 / 30.0, 1e-6);
  EXPECT_NEAR(found->value, top + 0.05, 5e-3);
  EXPECT_EQ(found->limit, top);
}

TEST(Reference, ContactsDependLittleOnTheRate) {
  const RobotClip clip = reference_sway(load_shipped("unitree_g1"), 40);
  const MotionReference coarse = reference_of(clip, 25.0), fine = reference_of(clip, 250.0);
  const std::size_t points = coarse.contact_names.size();
  int differ = 0;
  for (std::size_t i = 0; i < coarse.samples; ++i) {
    for (std::size_t p = 0; p < points; ++p) {
      const auto same = std::ranges::find(fine.contact_names, coarse.contact_names[p]);
      ASSERT_NE(same, fine.contact_names.end());
      const auto column = static_cast<std::size_t>(same - fine.contact_names.begin());
      differ += coarse.contacts[points * i + p] !=
                fine.contacts[fine.contact_names.size() * 10 * i + column];
    }
  }
  EXPECT_LE(differ, static_cast<int>(coarse.samples * points / 20));
}

TEST(Reference, RejectsWrongRatesAndEmptyMotions) {
  const auto robot = load_shipped("unitree_g1");
  ReferenceOptions options;
  for (const FrameRate& rate : {FrameRate{9, 1}, FrameRate{1001, 1}}) {
    options.rate = rate;
    const auto made = make_reference(reference_stand(robot, 5), options);
    ASSERT_FALSE(made.has_value());
    EXPECT_EQ(made.error().kind, ErrorKind::kUsage);
  }
  options.rate = {200, 1};
  EXPECT_FALSE(make_reference(RobotClip(robot, {30, 1}, 0), options).has_value());
  for (const int frames : {1, 2, 3}) {
    const auto made = value_of(make_reference(reference_stand(robot, frames), options));
    EXPECT_EQ(made.samples, static_cast<std::size_t>(20 * (frames - 1) / 3 + 1));
  }
  options.max_bytes = 1000;
  const auto large = make_reference(reference_stand(robot, 30), options);
  ASSERT_FALSE(large.has_value());
  EXPECT_EQ(large.error().kind, ErrorKind::kInput);
}

TEST(Reference, TextColumnsMatchTheArrays) {
  const MotionReference reference =
      reference_of(reference_sway(load_shipped("unitree_g1"), 10), 50.0);
  const std::string text = format_reference_csv(reference);
  const std::vector<std::string> columns = reference_columns(reference);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), reference.samples + 1);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text.substr(0, text.find('\n')), ',')),
            columns.size() - 1);
  EXPECT_EQ(columns.size(), 1 + 36 + 35 + 35 + 29 + 6 + 12 + 7 * reference.contact_names.size());
  EXPECT_EQ(columns.front(), "time");
  EXPECT_TRUE(format_reference_npz(reference).has_value());
}

}  // namespace
}  // namespace retarget
