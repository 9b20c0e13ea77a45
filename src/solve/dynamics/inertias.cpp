#include "solve/dynamics/inertias.h"

#include <limits>

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>

#include "retarget/kinematic_tree.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Combined inertia of two rigidly joined bodies.
LinkInertia joined(const LinkInertia& a, const LinkInertia& b) {
  LinkInertia sum;
  sum.mass = a.mass + b.mass;
  if (sum.mass <= 0.0) return sum;
  sum.com = (a.mass * a.com + b.mass * b.com) / sum.mass;
  sum.about_com = a.about_com + b.about_com + point_inertia(a.mass, a.com - sum.com) +
                  point_inertia(b.mass, b.com - sum.com);
  return sum;
}

LinkInertia body_in_link(const mjModel& model, int body, const Pose& link_from_body) {
  const mjtNum *position = model.body_ipos + 3L * body, *quaternion = model.body_iquat + 4L * body;
  const mjtNum* principal = model.body_inertia + 3L * body;
  const Pose body_from_axes{
      Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3]),
      {position[0], position[1], position[2]}};
  const Pose link_from_axes = link_from_body * body_from_axes;
  const Matrix3d axes = link_from_axes.rotation.toRotationMatrix();
  LinkInertia inertia;
  inertia.mass = model.body_mass[body];
  inertia.com = link_from_axes.translation;
  inertia.about_com =
      axes * Vector3d(principal[0], principal[1], principal[2]).asDiagonal() * axes.transpose();
  return inertia;
}

}  // namespace

Inertias make_inertias(const Robot& robot) {
  const KinematicTree& tree = robot.tree();
  const mjModel& model = *robot.model();
  Inertias inertias;
  inertias.links.resize(tree.links().size());
  inertias.rotors.assign(tree.links().size(), 0.0);
  for (int body = 1; body < model.nbody; ++body) {
    const KinematicTree::Attachment& at = tree.attachment(body);
    if (at.link == KinematicTree::kWorld) continue;
    LinkInertia& link = inertias.links[at.link];
    link = joined(link, body_in_link(model, body, at.link_from_body));
  }
  for (std::size_t i = 1; i < tree.links().size(); ++i) {
    inertias.rotors[i] = robot.rotor_inertia(tree.links()[i].joint);
  }
  for (const LinkInertia& link : inertias.links) inertias.mass += link.mass;
  return inertias;
}

std::vector<double> torque_limits_of(const Robot& robot) {
  const auto& links = robot.tree().links();
  std::vector<double> limits(links.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 1; i < links.size(); ++i) limits[i] = robot.torque_limit(links[i].joint);
  return limits;
}

}  // namespace retarget
