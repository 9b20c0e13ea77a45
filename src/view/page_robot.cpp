#include "robot/model/kinematic_tree.h"
#include "view/figure.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

Json pose_json(const Pose& pose) {
  const auto& [q, p] = pose;
  return Json::array({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
}

Json link_json(const KinematicTree::Link& link) {
  Json json = {{"parent", link.parent}};
  if (link.joint < 0) return json;
  json["joint"] = link.joint;
  if (link.slides) json["slides"] = true;
  if (link.reference != 0.0) json["reference"] = link.reference;
  json["pose"] = pose_json(link.parent_from_link);
  return json;
}

Json shape_json(const CollisionShape& shape) {
  Json json = {{"body", shape.body}, {"pose", pose_json(shape.body_from_shape)}};
  switch (shape.type) {
    case CollisionShape::Type::kSphere:
      json["sphere"] = shape.radius;
      break;
    case CollisionShape::Type::kCapsule:
      json["capsule"] = {shape.radius, shape.half_length};
      break;
    case CollisionShape::Type::kBox:
      json["box"] = vector_json(shape.half_size);
      break;
  }
  return json;
}

}  // namespace

Json page_robot(const Robot& robot) {
  Json links = Json::array(), bodies = Json::array(), joints = Json::array();
  Json shapes = Json::array(), soles = Json::array();
  for (const KinematicTree::Link& link : robot.tree().links()) links.push_back(link_json(link));
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const RobotBody& body = robot.bodies()[i];
    const auto& [link, pose] = robot.tree().attachment(static_cast<int>(i));
    bodies.push_back(
        {{"name", body.name}, {"parent", body.parent}, {"link", link}, {"pose", pose_json(pose)}});
  }
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const RobotJoint& joint = robot.joints()[i];
    Json json = {{"name", joint.name}, {"body", joint.body}};
    if (joint.type == RobotJoint::Type::kSlide) json["slides"] = true;
    const double speed = robot.speed_limit(static_cast<int>(i));
    if (std::isfinite(speed)) json["speed"] = speed;
    joints.push_back(std::move(json));
  }
  for (const CollisionShape& shape : visible_shapes(robot)) shapes.push_back(shape_json(shape));
  for (const Sole& sole : robot.profile().soles) {
    Json points = Json::array();
    for (const Eigen::Vector3d& point : sole.points) points.push_back(vector_json(point));
    soles.push_back({{"side", sole.side}, {"body", sole.body}, {"points", std::move(points)}});
  }
  return {{"name", robot.name()},
          {"variant", robot.variant().name},
          {"root", robot.root_body()},
          {"links", std::move(links)},
          {"bodies", std::move(bodies)},
          {"joints", std::move(joints)},
          {"outputs", robot.output_joints()},
          {"shapes", std::move(shapes)},
          {"soles", std::move(soles)}};
}

}  // namespace retarget
