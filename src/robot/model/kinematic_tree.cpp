#include "retarget/kinematic_tree.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "base/math/simd.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

std::vector<int> all_bodies(const Robot& robot) {
  std::vector<int> bodies(robot.bodies().size());
  std::iota(bodies.begin(), bodies.end(), 0);
  return bodies;
}

// Marks all bodies on the paths from the given bodies to the world.
std::vector<char> carrying_bodies(const Robot& robot, std::span<const int> bodies) {
  std::vector<char> carries(robot.bodies().size(), 0);
  for (int body : bodies) {
    for (; body != 0 && carries[body] == 0; body = robot.bodies()[body].parent) carries[body] = 1;
  }
  return carries;
}

// Returns q rotated about its own z axis, by the angle whose half has this sine and cosine.
inline Eigen::Quaterniond turned_about_z(const Eigen::Quaterniond& q,
                                         const portable::SineCosine& half) {
  const auto [s, c] = half;
  return {q.w() * c - q.z() * s, q.x() * c + q.y() * s, q.y() * c - q.x() * s,
          q.z() * c + q.w() * s};
}

Eigen::Vector3d z_axis_of(const Eigen::Quaterniond& q) {
  return {2.0 * (q.x() * q.z() + q.w() * q.y()), 2.0 * (q.y() * q.z() - q.w() * q.x()),
          1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())};
}

// Rotates v by the unit quaternion q.
inline Eigen::Vector3d turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d twice = 2.0 * q.vec().cross(v);
  return v + q.w() * twice + q.vec().cross(twice);
}

// Computes a link's pose from its parent's pose; both poses may be the same object. Returns the
// joint's axis in the world.
// @param half_turn  sine and cosine of half the joint's travel.
inline Eigen::Vector3d place_link(const KinematicTree::Link& link, const Pose& world_from_parent,
                                  double travel, const portable::SineCosine& half_turn,
                                  Pose& world_from_link) {
  const Eigen::Quaterniond rotation = world_from_parent.rotation * link.parent_from_link.rotation;
  Eigen::Vector3d axis = z_axis_of(rotation);
  world_from_link.translation =
      world_from_parent.translation +
      turned(world_from_parent.rotation, link.parent_from_link.translation);
  if (link.slides) {
    world_from_link.rotation = rotation;
    world_from_link.translation += travel * axis;
  } else {
    world_from_link.rotation = turned_about_z(rotation, half_turn);
  }
  return axis;
}

}  // namespace

KinematicTree::KinematicTree(const Robot& robot) : KinematicTree(robot, all_bodies(robot)) {}

KinematicTree::KinematicTree(const Robot& robot, std::span<const int> bodies)
    : attachments_(robot.bodies().size()), link_of_joint_(robot.joints().size(), kWorld) {
  const std::vector<char> carries = carrying_bodies(robot, bodies);
  links_.emplace_back().body = robot.root_body();
  std::size_t j = 0;
  for (std::size_t b = 1; b < attachments_.size(); ++b) {
    const RobotBody& body = robot.bodies()[b];
    Attachment& at = attachments_[b];
    at = attachments_[body.parent];
    at.link_from_body = at.link_from_body * body.parent_from_body;
    if (static_cast<int>(b) == robot.root_body()) at = {0, Pose{}};
    for (; j < robot.joints().size() && robot.joints()[j].body == static_cast<int>(b); ++j) {
      if (carries[b] == 0) continue;
      const RobotJoint& joint = robot.joints()[j];
      const Pose body_from_link{rotation_between(Eigen::Vector3d::UnitZ(), joint.axis),
                                joint.anchor};
      Link link;
      link.parent = at.link;
      link.body = joint.body;
      link.joint = static_cast<int>(j);
      link.slides = joint.type == RobotJoint::Type::kSlide;
      link.qpos_address = joint.qpos_address;
      link.reference = joint.reference;
      link.parent_from_link = at.link_from_body * body_from_link;
      link_of_joint_[j] = static_cast<int>(links_.size());
      at = {link_of_joint_[j], body_from_link.inverse()};
      links_.push_back(link);
    }
  }
  for (int i = static_cast<int>(links_.size()) - 1; i >= 0; --i) {
    links_[i].last_descendant = std::max(links_[i].last_descendant, i);
    if (i == 0) break;
    int& last = links_[links_[i].parent].last_descendant;
    last = std::max(last, links_[i].last_descendant);
  }
  number_dofs();
}

// The base carries all links; a link's carriers are its parent's carriers and its own joint.
void KinematicTree::number_dofs() {
  row_begin_.push_back(0);
  for (int dof = 0; dof < dof_count(); ++dof) {
    const int above = dof < kBaseDofs ? dof - 1 : dof_of(links_[dof - dof_of(0)].parent);
    if (above >= 0) {
      const std::vector<int> carriers(carriers_.begin() + row_begin_[above],
                                      carriers_.begin() + row_begin_[above + 1]);
      carriers_.insert(carriers_.end(), carriers.begin(), carriers.end());
    }
    carriers_.push_back(dof);
    row_begin_.push_back(static_cast<int>(carriers_.size()));
  }
}

std::vector<int> KinematicTree::children(int link) const {
  std::vector<int> children;
  for (int child = link + 1; child <= links_[link].last_descendant;
       child = links_[child].last_descendant + 1) {
    children.push_back(child);
  }
  return children;
}

int KinematicTree::carrier(int body) const {
  const int link = attachments_[body].link;
  return link == kWorld ? 0 : links_[link].body;
}

std::vector<int> KinematicTree::rigid_group(int body) const {
  std::vector<int> group;
  for (int b = body; b < static_cast<int>(attachments_.size()); ++b) {
    if (carrier(b) == body) group.push_back(b);
  }
  return group;
}

TreeState::TreeState(const KinematicTree& of)
    : tree(&of),
      world_from_link(of.links().size()),
      linear(of.dof_count(), Eigen::Vector3d::Zero()),
      angular(of.dof_count(), Eigen::Vector3d::Zero()),
      half_travel_(of.links().size()),
      sine_(of.links().size()),
      cosine_(of.links().size()) {
  for (int k = 0; k < 3; ++k) linear[k] = Eigen::Vector3d::Unit(k);
}

void TreeState::update(std::span<const double> qpos) {
  update_up_to(static_cast<int>(world_from_link.size()) - 1, qpos);
}

void TreeState::update_up_to(int last, std::span<const double> qpos) {
  Pose& base = world_from_link[0];
  base.translation = {qpos[0], qpos[1], qpos[2]};
  base.rotation = root_rotation(qpos).normalized();
  const Eigen::Matrix3d axes = base.rotation.toRotationMatrix();
  for (int k = 0; k < 3; ++k) angular[3 + k] = axes.col(k);
  place_links(1, last, qpos);
}

void TreeState::update_subtree(int link, std::span<const double> qpos) {
  place_links(link, tree->links()[link].last_descendant, qpos);
}

// Pointers, because the containers' bounds checks would take a quarter of the time.
void TreeState::place_links(int first, int last, std::span<const double> values) {
  const KinematicTree::Link* const links = tree->links().data();
  const double* const qpos = values.data();
  Pose* const places = world_from_link.data();
  double* const half_travel = half_travel_.data();
  const double *const sine = sine_.data(), *const cosine = cosine_.data();
  const int count = last - first + 1;
  for (int k = 0; k < count; ++k) {
    const KinematicTree::Link& link = links[first + k];
    half_travel[k] = 0.5 * (qpos[link.qpos_address] - link.reference);
  }
  sin_cos_all(std::span(half_travel_).first(static_cast<std::size_t>(count)), sine_, cosine_);
  const Eigen::Vector3d base = places[0].translation;
  for (int k = 0; k < count; ++k) {
    const KinematicTree::Link& link = links[first + k];
    Pose& place = places[first + k];
    const Eigen::Vector3d axis =
        place_link(link, places[link.parent], 2.0 * half_travel[k], {sine[k], cosine[k]}, place);
    const int dof = KinematicTree::dof_of(first + k);
    if (link.slides) {
      linear.data()[dof] = axis;
    } else {
      linear.data()[dof] = axis.cross(base - place.translation);
      angular.data()[dof] = axis;
    }
  }
}

Pose TreeState::world_from_body(int body) const {
  const KinematicTree::Attachment& attachment = tree->attachment(body);
  if (attachment.link == KinematicTree::kWorld) return attachment.link_from_body;
  const Pose& link = world_from_link[attachment.link];
  return {link.rotation * attachment.link_from_body.rotation,
          link.translation + turned(link.rotation, attachment.link_from_body.translation)};
}

const Eigen::Vector3d& TreeState::anchor(int joint) const {
  return world_from_link[tree->link_of_joint(joint)].translation;
}

const Eigen::Vector3d& TreeState::axis(int joint) const {
  return (slides(joint) ? linear : angular)[KinematicTree::dof_of(tree->link_of_joint(joint))];
}

void forward_kinematics(const Robot& robot, std::span<const double> qpos,
                        std::span<Pose> world_from_body) {
  const std::vector<KinematicTree::Link>& links = robot.tree().links();
  // Links that carry the bodies; links and bodies are both sorted by body, so one pass suffices.
  world_from_body[0] = Pose{};
  std::size_t i = 1;
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    Pose& world = world_from_body[b];
    world = world_from_body[robot.bodies()[b].parent];
    if (static_cast<int>(b) == robot.root_body()) {
      world = {root_rotation(qpos).normalized(), {qpos[0], qpos[1], qpos[2]}};
    }
    for (; i < links.size() && links[i].body == static_cast<int>(b); ++i) {
      const double travel = qpos[links[i].qpos_address] - links[i].reference;
      place_link(links[i], world, travel, portable::sin_cos(0.5 * travel), world);
    }
  }
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    world_from_body[b] =
        world_from_body[b] * robot.tree().attachment(static_cast<int>(b)).link_from_body;
  }
}

Eigen::Vector3d common_point(const TreeState& state, std::span<const int> joints) {
  constexpr double kPullToAnchor = 0.01;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const int joint : joints) {
    const Eigen::Vector3d& axis = state.axis(joint);
    Eigen::Matrix3d across = (1.0 + kPullToAnchor) * Eigen::Matrix3d::Identity();
    if (!state.slides(joint)) across -= axis * axis.transpose();
    a += across;
    b += across * state.anchor(joint);
  }
  return a.inverse() * b;
}

}  // namespace retarget
