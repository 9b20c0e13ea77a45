#include "scene/change_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "retarget/so3.h"
#include "scene/scene_shapes.h"
#include "scene/scene_world.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = SceneShape::Type;

// The axis of a shape that is parallel to the world's z; -1: none.
int upright_axis(const Eigen::Quaterniond& world_from_shape) {
  constexpr double kParallel = 1.0 - 1e-9;
  const Vector3d up = world_from_shape.conjugate() * Vector3d::UnitZ();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(up[axis]) >= kParallel) return axis;
  }
  return -1;
}

// Scales a shape's size. @return false if the result is not of the shape's type.
bool scale_size(const Vector3d& factors, int upright, SceneShape& shape) {
  const bool uniform = factors.x() == factors.z() && factors.x() == factors.y();
  if (uniform) {
    const Vector3d centre = shape.body_from_shape.translation;
    shape = scaled_shape(std::move(shape), factors.x());
    shape.body_from_shape.translation = centre;
    return true;
  }
  if (factors.x() != factors.y() || upright < 0) return false;
  if (shape.type == Type::kBox) {
    for (int axis = 0; axis < 3; ++axis) {
      shape.half_size[axis] *= axis == upright ? factors.z() : factors.x();
    }
    return true;
  }
  if (shape.type == Type::kCylinder && upright == 2) {
    shape.radius *= factors.x();
    shape.half_length *= factors.z();
    return true;
  }
  return false;
}

void tilt_plane(const Vector3d& factors, SceneShape& shape, const Eigen::Quaterniond& body) {
  const Vector3d normal = body * shape.body_from_shape.rotation * Vector3d::UnitZ();
  const Vector3d scaled = normal.cwiseQuotient(factors).normalized();
  const Eigen::Quaterniond world_from_plane =
      rotation_between(normal, scaled) * body * shape.body_from_shape.rotation;
  shape.body_from_shape.rotation = (body.conjugate() * world_from_plane).normalized();
}

}  // namespace

void bring_to_world(const Eigen::Matrix3d& world_from_file, double unit, Scene& scene,
                    std::span<ObjectTrack> tracks) {
  const Eigen::Quaterniond turn(world_from_file);
  const auto convert = [&](Pose& pose) {
    pose.translation = unit * (turn * pose.translation);
    pose.rotation = (turn * pose.rotation).normalized();
  };
  for (SceneBody& body : scene.bodies) {
    convert(body.world_from_body);
    for (SceneShape& shape : body.shapes) shape = scaled_shape(std::move(shape), unit);
  }
  for (ObjectTrack& track : tracks) std::ranges::for_each(track.world_from_body, convert);
}

void scale_static_body(const Vector3d& factors, SceneBody& body) {
  const Eigen::Quaterniond& turn = body.world_from_body.rotation;
  // The linear map of the body's frame that corresponds to the scaling of the world.
  const auto scaled = [&](const Vector3d& in_body) -> Vector3d {
    return turn.conjugate() * factors.cwiseProduct(turn * in_body);
  };
  for (SceneShape& shape : body.shapes) {
    const int upright = upright_axis(turn * shape.body_from_shape.rotation);
    if (shape.type == Type::kPlane) {
      tilt_plane(factors, shape, turn);
    } else if (!scale_size(factors, upright, shape)) {
      auto mesh = std::make_shared<TriangleMesh>(mesh_of_shape(shape));
      for (Vector3d& vertex : mesh->vertices) vertex = scaled(vertex);
      shape = {};
      shape.type = Type::kMesh;
      shape.mesh = std::move(mesh);
      continue;
    }
    shape.body_from_shape.translation = scaled(shape.body_from_shape.translation);
  }
  body.world_from_body.translation = factors.cwiseProduct(body.world_from_body.translation);
}

void change_objects(const Vector3d& shift, double scale, std::span<const DistanceField> fields,
                    Scene& scene, std::span<ObjectTrack> tracks) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    SceneBody& body = scene.bodies[i];
    if (!body.moves) continue;
    const BodyAnchor anchor(body, fields[i]);
    const auto change = [&](Pose& pose) {
      pose.translation += shift + (1.0 - scale) * anchor.at(pose.rotation);
    };
    change(body.world_from_body);
    for (ObjectTrack& track : tracks) {
      if (track.body == body.name) std::ranges::for_each(track.world_from_body, change);
    }
    if (scale == 1.0) continue;
    body.mass *= scale * scale * scale;
    for (SceneShape& shape : body.shapes) shape = scaled_shape(std::move(shape), scale);
  }
}

}  // namespace retarget
