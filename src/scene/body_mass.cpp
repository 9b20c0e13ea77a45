#include "scene/body_mass.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "retarget/write_scene.h"

namespace retarget {

MeshVolume volume_of(const TriangleMesh& mesh) {
  MeshVolume volume;
  // Compute relative to a vertex, so that a closed mesh far from the origin keeps its precision.
  const Eigen::Vector3d& from = mesh.vertices.front();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto corner = [&](int index) -> Eigen::Vector3d {
      return mesh.vertices[static_cast<std::size_t>(index)] - from;
    };
    const double part = corner(a).dot(corner(b).cross(corner(c))) / 6.0;
    volume.size += part;
    volume.moment += part * (corner(a) + corner(b) + corner(c)) / 4.0;
  }
  return volume;
}

namespace {

using Eigen::Vector3d;

// A volume and its centroid, in the frame of a shape.
struct Volume {
  double size = 0.0;  // Cubic metres.
  Vector3d centre = Vector3d::Zero();
};

Volume solid_volume(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& vertex : mesh.vertices) box.extend(vertex);
  if (box.isEmpty()) return {};
  const MeshVolume enclosed = volume_of(mesh);
  constexpr double kHollow = 1e-3;  // Share of the box.
  if (std::abs(enclosed.size) < kHollow * box.volume()) return {box.volume(), box.center()};
  const Vector3d centre = mesh.vertices.front() + enclosed.moment / enclosed.size;
  // The centroid of a mesh with holes may lie anywhere.
  return {std::abs(enclosed.size), box.contains(centre) ? centre : box.center()};
}

Volume solid_volume(const SceneShape& shape) {
  using Type = SceneShape::Type;
  const double disc = std::numbers::pi * shape.radius * shape.radius;
  const double ball = 4.0 / 3.0 * disc * shape.radius;
  switch (shape.type) {
    case Type::kPlane:
      return {};
    case Type::kBox:
      return {8.0 * shape.half_size.prod()};
    case Type::kSphere:
      return {ball};
    case Type::kCapsule:
      return {2.0 * shape.half_length * disc + ball};
    case Type::kCylinder:
      return {2.0 * shape.half_length * disc};
    case Type::kMesh:
      return shape.mesh ? solid_volume(*shape.mesh) : Volume{};
  }
  return {};
}

}  // namespace

BodyMass body_mass(const SceneBody& body) {
  double size = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (const SceneShape& shape : body.shapes) {
    const Volume volume = solid_volume(shape);
    size += volume.size;
    moment += volume.size * (shape.body_from_shape * volume.centre);
  }
  BodyMass result;
  result.mass = body.mass > 0.0 ? body.mass : kObjectDensity * size;
  if (size > 0.0) result.com = moment / size;
  return result;
}

}  // namespace retarget
