#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// A random configuration of any robot, joints uniform in +-pi (rad or m).
inline std::vector<double> random_configuration(const Robot& robot, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(-M_PI, M_PI);
  std::vector<double> qpos = robot.zero_configuration();
  for (int i = 0; i < 7; ++i) qpos[i] = normal(random);
  const double norm = std::hypot(std::hypot(qpos[3], qpos[4]), std::hypot(qpos[5], qpos[6]));
  for (int i = 3; i < 7; ++i) qpos[i] /= norm;
  for (const RobotJoint& joint : robot.joints()) qpos[joint.qpos_address] = angle(random);
  return qpos;
}

/// World poses of all bodies by MuJoCo.
inline std::vector<Pose> mujoco_kinematics(const mjModel& model, const std::vector<double>& qpos) {
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), mj_deleteData);
  std::copy(qpos.begin(), qpos.end(), data->qpos);
  mj_kinematics(&model, data.get());
  std::vector<Pose> poses;
  for (int b = 0; b < model.nbody; ++b) {
    const double* q = data->xquat + 4 * b;
    const double* p = data->xpos + 3 * b;
    poses.push_back({{q[0], q[1], q[2], q[3]}, {p[0], p[1], p[2]}});
  }
  return poses;
}

/// World poses of all bodies by an independent tree walk.
inline std::vector<Pose> own_kinematics(const Robot& robot, const std::vector<double>& qpos) {
  std::vector<Pose> poses(robot.bodies().size());
  forward_kinematics(robot, qpos, poses);
  return poses;
}

/// The largest difference of two poses: metres, or entries of the rotation matrix.
inline double difference(const Pose& a, const Pose& b) {
  return std::max(
      (a.translation - b.translation).cwiseAbs().maxCoeff(),
      (a.rotation.toRotationMatrix() - b.rotation.toRotationMatrix()).cwiseAbs().maxCoeff());
}

}  // namespace retarget
