#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/pose.h"
#include "retarget/scene.h"

namespace retarget {
namespace {

// The reflection of the axes of a body or shape: y becomes -y. Each primitive equals its image.
Eigen::Matrix3d local_reflection() {
  return Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
}

Pose mirrored_locally(const Pose& pose) {
  const Eigen::Matrix3d local = local_reflection();
  const Eigen::Matrix3d turned = local * pose.rotation.toRotationMatrix() * local;
  return {Eigen::Quaterniond(turned), local * pose.translation};
}

Pose mirrored_in_world(const MirrorPlane& plane, const Pose& world_from_body) {
  const Eigen::Matrix3d reflection =
      Eigen::Matrix3d::Identity() - 2.0 * plane.normal * plane.normal.transpose();
  const Eigen::Matrix3d turned =
      reflection * world_from_body.rotation.toRotationMatrix() * local_reflection();
  return {Eigen::Quaterniond(turned),
          plane.point + reflection * (world_from_body.translation - plane.point)};
}

std::shared_ptr<const TriangleMesh> mirrored(const TriangleMesh& mesh) {
  TriangleMesh image = mesh;
  for (Eigen::Vector3d& vertex : image.vertices) vertex.y() = -vertex.y();
  // A reflection turns triangles inside out.
  for (auto& triangle : image.triangles) std::swap(triangle[1], triangle[2]);
  return std::make_shared<const TriangleMesh>(std::move(image));
}

}  // namespace

std::string part_of_other_side(const std::string& part) {
  constexpr std::string_view kLeft = "left_", kRight = "right_";
  if (part.starts_with(kLeft)) return std::string(kRight) + part.substr(kLeft.size());
  if (part.starts_with(kRight)) return std::string(kLeft) + part.substr(kRight.size());
  return part;
}

void mirror_scene(const MirrorPlane& plane, Scene& scene, std::span<ObjectTrack> tracks) {
  for (SceneBody& body : scene.bodies) {
    body.world_from_body = mirrored_in_world(plane, body.world_from_body);
    for (SceneShape& shape : body.shapes) {
      shape.body_from_shape = mirrored_locally(shape.body_from_shape);
      if (shape.mesh) shape.mesh = mirrored(*shape.mesh);
    }
  }
  for (ObjectTrack& track : tracks) {
    for (Pose& pose : track.world_from_body) pose = mirrored_in_world(plane, pose);
    for (StatedContact& contact : track.contacts) contact.part = part_of_other_side(contact.part);
  }
}

}  // namespace retarget
