#include "ik/moving_tree.h"

#include "math/so3.h"
#include "math/trigonometry.h"

namespace retarget {
namespace {

// bodies between the bodies of interest and the world
std::vector<char> carrying_bodies(const Robot& robot, std::span<const int> bodies) {
  std::vector<char> carries(robot.bodies().size(), 0);
  for (int body : bodies) {
    for (; body != 0 && carries[body] == 0; body = robot.bodies()[body].parent) carries[body] = 1;
  }
  return carries;
}

// body_from_node: a frame at a joint's anchor whose z axis is the joint's
Pose joint_frame(const RobotJoint& joint) {
  return {rotation_between(Eigen::Vector3d::UnitZ(), joint.axis), joint.anchor};
}

// q times a turn by `angle` about its own z axis
Eigen::Quaterniond turned_about_z(const Eigen::Quaterniond& q, double angle) {
  const auto [s, c] = portable::sin_cos(0.5 * angle);
  return {q.w() * c - q.z() * s, q.x() * c + q.y() * s, q.y() * c - q.x() * s,
          q.z() * c + q.w() * s};
}

Eigen::Vector3d z_axis_of(const Eigen::Quaterniond& q) {
  return {2.0 * (q.x() * q.z() + q.w() * q.y()), 2.0 * (q.y() * q.z() - q.w() * q.x()),
          1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())};
}

// v turned by the unit quaternion q
Eigen::Vector3d turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d twice = 2.0 * q.vec().cross(v);
  return v + q.w() * twice + q.vec().cross(twice);
}

}  // namespace

MovingTree::MovingTree(const Robot& robot, std::span<const int> bodies) {
  const std::vector<char> carries = carrying_bodies(robot, bodies);
  const auto& all = robot.bodies();
  std::vector<Attachment> where(all.size());
  std::size_t j = 0;
  for (std::size_t b = 1; b < all.size(); ++b) {
    if (static_cast<int>(b) == robot.root_body()) {
      where[b] = {kBase, Pose{}};
    } else {
      const Attachment& parent = where[all[b].parent];
      where[b] = {parent.node, parent.node_from_body * all[b].parent_from_body};
    }
    for (; j < robot.joints().size() && robot.joints()[j].body == static_cast<int>(b); ++j) {
      if (carries[b] == 0) continue;
      const RobotJoint& joint = robot.joints()[j];
      const Pose body_from_node = joint_frame(joint);
      Node node;
      node.parent = where[b].node;
      node.slides = joint.type == RobotJoint::Type::kSlide;
      node.joint = static_cast<int>(j);
      node.qpos_address = joint.qpos_address;
      node.reference = joint.reference;
      node.parent_from_node = where[b].node_from_body * body_from_node;
      node.depth = node.parent == kBase ? 0 : nodes_[node.parent].depth + 1;
      where[b] = {static_cast<int>(nodes_.size()), body_from_node.inverse()};
      nodes_.push_back(node);
    }
  }
  for (int i = static_cast<int>(nodes_.size()) - 1; i >= 0; --i) {
    nodes_[i].last_descendant = std::max(nodes_[i].last_descendant, i);
    if (nodes_[i].parent == kBase) continue;
    int& last = nodes_[nodes_[i].parent].last_descendant;
    last = std::max(last, nodes_[i].last_descendant);
  }
  for (const int body : bodies) attachments_.push_back(where[body]);
}

void TreeState::update(const MovingTree& tree, std::span<const double> qpos) {
  world_from_base.translation = {qpos[0], qpos[1], qpos[2]};
  world_from_base.rotation = Eigen::Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]).normalized();
  for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
    const MovingTree::Node& node = tree.nodes()[i];
    const Pose& parent =
        node.parent == MovingTree::kBase ? world_from_base : world_from_node[node.parent];
    const Eigen::Quaterniond rotation = parent.rotation * node.parent_from_node.rotation;
    const double travel = qpos[node.qpos_address] - node.reference;
    Pose& world = world_from_node[i];
    world.translation =
        parent.translation + turned(parent.rotation, node.parent_from_node.translation);
    axis[i] = z_axis_of(rotation);
    if (node.slides) {
      world.rotation = rotation;
      world.translation += travel * axis[i];
    } else {
      world.rotation = turned_about_z(rotation, travel);
    }
  }
}

Pose TreeState::world_from_body(const MovingTree::Attachment& attachment) const {
  if (attachment.node == MovingTree::kWorld) return attachment.node_from_body;
  const Pose& node =
      attachment.node == MovingTree::kBase ? world_from_base : world_from_node[attachment.node];
  return {node.rotation * attachment.node_from_body.rotation,
          node.translation + turned(node.rotation, attachment.node_from_body.translation)};
}

}  // namespace retarget
